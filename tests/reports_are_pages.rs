//! Promise: the report of a batch is one page that needs nothing else: valid, without scripts and without a name of anything elsewhere, with names of people
//! escaped; its plots say what the rows say; Chromium draws it as people would see it, wide and narrow.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/skip.rs"]
mod skip;

use foliate::batch::improvement::{Budget, Measurement};
use foliate::batch::report::report_page;
use foliate::batch::{Batch, Entry, Row, Seeds, Settings, Variant};
use foliate::components::samples::{boxes_on_a_table, move_one_box};
use foliate::systems::settings::SearchSettings;
use skip::browser;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Duration;

/// A name as nobody has it, for what pages make of it.
const HOSTILE: &str = "<b>\"box\" & 'tables' </svg><script>alert(1)</script>";

/// The page of a batch with all that a page can have: several scenes, settings and numbers of threads, improvements, rows without a path.
fn page() -> &'static (Vec<Row>, String) {
    static PAGE: OnceLock<(Vec<Row>, String)> = OnceLock::new();
    PAGE.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("foliate-report-{}", std::process::id()));
        let _fresh = std::fs::remove_dir_all(&folder);
        let hostile = |mut problem: foliate::components::problem::Problem| {
            problem.name = HOSTILE.to_owned();
            problem
        };
        let swap = boxes_on_a_table(&[(0.6, 0.1), (0.6, -0.1)], &[(0.6, -0.1), (0.6, 0.1)]).unwrap();
        let mut inside = boxes_on_a_table(&[(0.6, 0.1), (0.6, 0.1)], &[(0.6, 0.1), (0.6, -0.1)]).unwrap();
        inside.name = "one in the other".to_owned();
        let problems = [hostile(move_one_box().unwrap()), swap, inside];
        let entries = problems.map(|problem| Entry::of_problem(problem).unwrap()).into();
        let settings = Settings {
            seeds: Seeds::new(1, 6).unwrap(),
            threads: 2,
            time_limit: Duration::from_secs(60),
            search: SearchSettings::default(),
            improvement: Some(Measurement::new(Budget::Work(400))),
        };
        let variant = |name: &str, candidates, threads| {
            let search = SearchSettings::default().with(|s| s.candidates = candidates);
            Variant { threads, ..Variant::new(name, search) }
        };
        let variants = vec![variant("usual", 16, 1), variant("wide", 32, 1), variant("two threads", 16, 2)];
        let batch = Batch::new(entries, settings).unwrap().variants(variants).unwrap();
        let rows = batch.run(&folder, |_| {}).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        let text = report_page(HOSTILE, &batch.table(&rows), &rows).unwrap();
        (rows, text)
    })
}

/// The page as XML: its elements are all closed, and `<meta>` is the only one that HTML leaves open.
fn parsed() -> String {
    let (_, text) = page();
    let body = text.strip_prefix("<!DOCTYPE html>\n").unwrap();
    body.lines()
        .map(|line| if line.starts_with("<meta ") { line.replace('>', "/>") } else { line.to_owned() } + "\n")
        .collect()
}

#[test]
fn the_page_is_whole_and_says_what_the_rows_say() {
    let (rows, text) = page();
    let xml = parsed();
    let document = roxmltree::Document::parse(&xml).unwrap_or_else(|error| panic!("{error}"));
    let elements = |name: &str| document.descendants().filter(|node| node.tag_name().name() == name).count();
    assert_eq!((elements("script"), elements("link"), elements("img"), elements("iframe")), (0, 0, 0, 0));
    assert!(!text.contains("<script") && !text.contains("<b>\"box"));
    // Nothing elsewhere is named but the name of the format of plots.
    let elsewhere = text.split("http").skip(1).filter(|rest| !rest.starts_with("://www.w3.org/2000/svg")).count();
    assert_eq!(elsewhere, 0);
    assert!(!text.contains("url(") && !text.contains("@import"));
    let title = document.descendants().find(|node| node.has_tag_name("h1")).unwrap();
    assert_eq!(title.text(), Some(HOSTILE));
    let headings: Vec<_> =
        document.descendants().filter(|node| node.has_tag_name("h2")).filter_map(|node| node.text()).collect();
    assert_eq!(
        headings,
        [
            "Summary",
            "Solved over time",
            "Times to the first path",
            "Cost over time",
            "Threads",
            "From rows to paths",
            "Environment"
        ]
    );
    // Two scenes were solved: two plots over time, one of boxes, two of costs, one of threads.
    let svg = "http://www.w3.org/2000/svg";
    let plots: Vec<_> = document.descendants().filter(|node| node.has_tag_name((svg, "svg"))).collect();
    assert_eq!(plots.len(), 6);
    assert!(plots.iter().all(|plot| plot.attribute("aria-label").is_some_and(|label| !label.is_empty())));
    let summary = document.descendants().find(|node| node.has_tag_name("tbody")).unwrap();
    let lines: Vec<Vec<String>> = summary
        .children()
        .filter(|node| node.has_tag_name("tr"))
        .map(|line| line.children().filter_map(|cell| cell.text().map(str::to_owned)).collect())
        .collect();
    assert_eq!(lines.len(), 9);
    assert_eq!(lines[0][..3], [HOSTILE, "sequence, usual", "6/6"]);
    assert_eq!(lines[8][..3], ["one in the other", "sequence, two threads", "0/6"]);
    assert_eq!(rows.iter().filter(|row| row.is_solved()).count(), 36);
    assert!(text.contains("<td>6 infeasible_start</td>"));
    assert!(text.contains("36") && text.contains("<b>66.7 %</b>"));
}

#[test]
fn a_page_without_rows_is_a_page() {
    let settings = Settings {
        seeds: Seeds::new(1, 1).unwrap(),
        threads: 1,
        time_limit: Duration::from_secs(1),
        search: SearchSettings::default(),
        improvement: None,
    };
    let batch = Batch::new(vec![Entry::of_problem(move_one_box().unwrap()).unwrap()], settings).unwrap();
    let text = report_page("nothing", &batch.table(&[]), &[]).unwrap();
    assert!(text.ends_with("</html>\n") && !text.contains("<svg") && text.contains("<b>0.0 %</b>"), "{text}");
}

/// Opens the page in Chromium and looks at it.
#[test]
fn the_page_is_seen() {
    let Some((node, modules, chromium)) = browser("the_page_is_seen") else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/pages/report");
    std::fs::create_dir_all(&folder).unwrap();
    let file: PathBuf = folder.join("report.html");
    std::fs::write(&file, &page().1).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("viewer/test/report.mjs");
    let mut command = Command::new(node);
    command.arg(script).arg(&folder).arg(&file);
    command.env("NODE_PATH", std::path::absolute(modules).unwrap()).env("FOLIATE_CHROMIUM", chromium);
    let out = command.output().unwrap();
    let told = String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned();
    assert!(out.status.success(), "{told}");
    assert!(folder.join("report-wide.png").is_file());
}
