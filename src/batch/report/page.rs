//! The page: where and how it was measured, tables, and plots.

use crate::batch::error::{BatchError, write_whole};
use crate::batch::improvement::chart::escaped;
use crate::batch::report::canvas::css_colour;
use crate::batch::report::groups::{Group, groups, scenes};
use crate::batch::report::solved::CONFIDENCE;
use crate::batch::report::{boxes, costs, funnel, scaling, solved};
use crate::batch::results::row::Row;
use crate::batch::results::table::{SceneSummary, Spread, Table};
use std::fmt::Write;
use std::path::Path;

/// Most groups with plots of their own; of more there are the tables and the boxes of the first.
const MOST: usize = 200;

const STYLE: &str = "
:root{color-scheme:light}
*{box-sizing:border-box}
body{margin:0;background:#f4f6f8;color:#1f2933;font:15px/1.5 system-ui,Helvetica,Arial,sans-serif}
main{max-width:960px;margin:0 auto;padding:28px 20px 60px}
h1{font-size:27px;line-height:1.25;margin:0 0 4px}
h2{font-size:19px;margin:0 0 4px}
h3{font-size:15px;margin:20px 0 4px}
p{margin:4px 0 10px;color:#52606d}
section{background:#fff;border:1px solid #dde2e8;border-radius:10px;padding:18px 20px;margin-top:18px}
table{border-collapse:collapse;width:100%;font-size:14px;font-variant-numeric:tabular-nums}
.wide{overflow-x:auto}
th,td{padding:5px 7px;border-bottom:1px solid #e9edf1;text-align:right;white-space:nowrap}
th{font-weight:600;color:#52606d}
th:first-child,td:first-child,.words td,.words th{text-align:left}
.words td{white-space:normal;overflow-wrap:anywhere}
h1,h3,p,.key{overflow-wrap:anywhere}
svg{display:block;width:100%;height:auto}
.key{display:inline-flex;align-items:center;gap:7px;margin:2px 18px 2px 0;color:#1f2933}
.key i{width:22px;height:5px;border-radius:3px;display:inline-block}
.figures{display:flex;flex-wrap:wrap;gap:12px;margin-top:16px}
.figure{flex:1 1 150px;background:#fff;border:1px solid #dde2e8;border-radius:10px;padding:12px 16px}
.figure b{display:block;font-size:24px;line-height:1.2}
.figure span{color:#52606d}
.bar{display:block;height:5px;border-radius:3px;margin-left:auto}
.named td:nth-child(-n+2),.named th:nth-child(-n+2){text-align:left}
.named td:first-child{white-space:normal;overflow-wrap:anywhere;min-width:130px}
";

/// Writes a page with plots of the rows of a batch.
///
/// # Errors
/// A plot that cannot be drawn, a file that cannot be written.
pub fn write_report(file: &Path, name: &str, table: &Table, rows: &[Row]) -> Result<(), BatchError> {
    write_whole(file, &report_page(name, table, rows)?)
}

/// The page: HTML that needs nothing else.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn report_page(name: &str, table: &Table, rows: &[Row]) -> Result<String, BatchError> {
    let (groups, kinds) = groups(rows);
    let mut page = String::with_capacity(1 << 16);
    let title = escaped(name);
    let _ = write!(
        page,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>{title}: batch report</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n"
    );
    heading(&mut page, table, rows, &groups);
    legend(&mut page, &kinds);
    summary(&mut page, &groups, &kinds);
    let drawn = &groups[..groups.len().min(MOST)];
    if groups.len() > MOST {
        let _ = writeln!(page, "<p>Plots are of the first {MOST} of {} groups.</p>", groups.len());
    }
    plots(&mut page, drawn, &kinds)?;
    funnels(&mut page, drawn, &kinds, table);
    environment(&mut page, table);
    page.push_str("</main>\n</body>\n</html>\n");
    Ok(page)
}

fn heading(page: &mut String, table: &Table, rows: &[Row], groups: &[Group<'_>]) {
    let solved = rows.iter().filter(|row| row.is_solved()).count();
    let _ = writeln!(
        page,
        "<p>foliate {}, {}; {}</p>",
        env!("CARGO_PKG_VERSION"),
        escaped(&table.date),
        escaped(&table.machine.to_string())
    );
    let share = if rows.is_empty() { 0.0 } else { 100.0 * solved as f64 / rows.len() as f64 };
    let median = Spread::of(groups.iter().flat_map(Group::times).collect()).map(|spread| time(spread.median));
    let figures = [
        (rows.len().to_string(), "rows"),
        (format!("{share:.1} %"), "solved"),
        (median.unwrap_or_else(|| "–".into()), "median time to the first path"),
        (scenes(groups).len().to_string(), "scenes"),
    ];
    page.push_str("<div class=\"figures\">\n");
    for (figure, what) in figures {
        let _ = writeln!(page, "<div class=\"figure\"><b>{figure}</b><span>{what}</span></div>");
    }
    page.push_str("</div>\n");
}

fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => format!("{:.3} ms", s * 1e3).replace(".000 ms", " ms"),
        s => format!("{s:.2} s"),
    }
}

/// What the colours mean.
fn legend(page: &mut String, kinds: &[String]) {
    if kinds.len() < 2 {
        return;
    }
    let _ = writeln!(page, "<section aria-label=\"Colours\">\n{}</section>", keys(kinds));
}

/// Names beside their colours.
fn keys(names: &[String]) -> String {
    let mut keys = String::new();
    for (number, name) in names.iter().enumerate() {
        let (colour, name) = (css_colour(number), escaped(name));
        let _ = writeln!(keys, "<span class=\"key\"><i style=\"background:{colour}\"></i>{name}</span>");
    }
    keys
}

fn summary(page: &mut String, groups: &[Group<'_>], kinds: &[String]) {
    page.push_str(
        "<section>\n<h2>Summary</h2>\n<p>Times are those to the first certified path, without loading, of the rows that have one.</p>\n\
         <div class=\"wide\"><table class=\"named\">\n<thead><tr><th>scene</th><th>scheduler</th><th>solved</th><th>time: min</th><th>median</th>\
         <th>max</th><th>nodes: min</th><th>median</th><th>max</th></tr></thead>\n<tbody>\n",
    );
    for group in groups {
        let line = SceneSummary::of_rows(group.scene, group.rows.iter().copied());
        let cells = |spread: Option<Spread>, cell: &dyn Fn(f64) -> String| match spread {
            Some(s) => [s.min, s.median, s.max].map(cell),
            None => ["–", "–", "–"].map(String::from),
        };
        let mut all = vec![format!("{}/{}", line.solved, line.runs)];
        all.extend(cells(line.time, &time));
        all.extend(cells(line.nodes, &|nodes| format!("{nodes:.0}")));
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{}</td><td>{}</td></tr>",
            escaped(group.scene),
            escaped(&kinds[group.kind]),
            all.join("</td><td>")
        );
    }
    page.push_str("</tbody></table></div>\n</section>\n");
}

/// Draws the groups of one scene, where there is something to draw.
type ScenePlot = fn(&str, &[&Group<'_>]) -> Result<Option<String>, BatchError>;

fn plots(page: &mut String, groups: &[Group<'_>], kinds: &[String]) -> Result<(), BatchError> {
    let of_scenes = |plot: ScenePlot| {
        let mut plots = Vec::new();
        for scene in scenes(groups) {
            let of_scene: Vec<&Group<'_>> = groups.iter().filter(|group| group.scene == scene).collect();
            plots.extend(plot(scene, &of_scene)?.map(|svg| (Some(scene), svg)));
        }
        Ok::<_, BatchError>(plots)
    };
    let band = CONFIDENCE * 100.0;
    let over_time = format!(
        "The share of all rows that have a path after a time. Bands: exact {band:.0} % intervals of each share (Clopper and Pearson), for \
         each time by itself."
    );
    section(page, "Solved over time", &over_time, of_scenes(solved::plot)?);
    let boxes = boxes::plot(groups, kinds)?.map(|svg| (None, svg)).into_iter().collect();
    let words = "Boxes from the lower to the upper quartile, the median as a line. Whiskers end at the last value within 1.5 heights of the \
                 box; dots are beyond. Right: rows that were solved, of all.";
    section(page, "Times to the first path", words, boxes);
    let words =
        "Median of the estimated cost of the best path by a time of improvement. Bands: 10th to 90th percentile.";
    section(page, "Cost over time", words, of_scenes(costs::plot)?);
    let scaling = scaling::plot(groups)?.map(|(svg, lines)| (None, format!("<p>{}</p>\n{svg}", keys(&lines))));
    let words = "Median time with the fewest threads over the median time with more; of settings with as many threads the first counts. Grey: as \
                 many times as fast as there are threads.";
    section(page, "Threads", words, scaling.into_iter().collect());
    Ok(())
}

/// Plots under a heading, each with its own where it has one; nothing where there are none.
fn section(page: &mut String, heading: &str, words: &str, plots: Vec<(Option<&str>, String)>) {
    if plots.is_empty() {
        return;
    }
    let _ = writeln!(page, "<section>\n<h2>{heading}</h2>\n<p>{words}</p>");
    for (name, svg) in plots {
        if let Some(name) = name {
            let _ = writeln!(page, "<h3>{}</h3>", escaped(name));
        }
        page.push_str(&svg);
        page.push('\n');
    }
    page.push_str("</section>\n");
}

fn funnels(page: &mut String, groups: &[Group<'_>], kinds: &[String], table: &Table) {
    page.push_str(
        "<section>\n<h2>From rows to paths</h2>\n<p>How many rows got how far: start and goal can be planned for, the search ended by itself or at \
         a limit, it found a path. The last column says how the others ended.</p>\n",
    );
    if !table.refused.is_empty() {
        let _ = writeln!(page, "<p>Draws that were no instance: {}.</p>", escaped(&table.refused.words()));
    }
    let (varied, improved) = (table.instances.is_some(), table.improvement.is_some());
    let all: Vec<Vec<funnel::Stage>> = groups.iter().map(|group| funnel::stages(group, varied, improved)).collect();
    page.push_str("<div class=\"wide\"><table class=\"named\">\n<thead><tr><th>scene</th><th>scheduler</th>");
    for (stage, _) in all.first().into_iter().flatten() {
        let _ = write!(page, "<th>{stage}</th>");
    }
    page.push_str("<th>without a path</th></tr></thead>\n<tbody>\n");
    for (group, stages) in groups.iter().zip(all) {
        let (scene, kind) = (escaped(group.scene), escaped(&kinds[group.kind]));
        let _ = write!(page, "<tr><td>{scene}</td><td>{kind}</td>");
        for (_, count) in stages {
            let (share, colour) = (100.0 * count as f64 / group.rows.len().max(1) as f64, css_colour(group.kind));
            let bar = format!("<i class=\"bar\" style=\"width:{share:.1}%;background:{colour}\"></i>");
            let _ = write!(page, "<td>{count}{bar}</td>");
        }
        let lost: Vec<String> =
            funnel::lost(group).into_iter().map(|(outcome, count)| format!("{count} {outcome}")).collect();
        let _ = writeln!(page, "<td>{}</td></tr>", lost.join(", "));
    }
    page.push_str("</tbody></table></div>\n</section>\n");
}

fn environment(page: &mut String, table: &Table) {
    let build = if cfg!(debug_assertions) { "debug build, whose times say nothing" } else { "release build" };
    let lines = [
        ("program", format!("foliate {}, {build}", env!("CARGO_PKG_VERSION"))),
        ("machine", table.machine.to_string()),
        ("date (UTC)", table.date.clone()),
        ("arithmetic", table.search.level.to_string()),
        ("schedulers", table.scheduler.clone()),
        ("seeds", table.seeds.to_string()),
        ("varied instances", table.instances.map_or_else(|| "none".into(), |count| count.to_string())),
        ("threads in all", table.threads.to_string()),
        ("time limit", format!("{} s", table.time_limit.as_secs_f64())),
        ("improvement", table.improvement.as_ref().map_or_else(|| "none".into(), |i| i.measurement.to_string())),
        ("settings of the search", format!("{:?}", table.search)),
    ];
    page.push_str("<section>\n<h2>Environment</h2>\n<table class=\"words\"><tbody>\n");
    for (what, value) in lines {
        let _ = writeln!(page, "<tr><th scope=\"row\">{what}</th><td>{}</td></tr>", escaped(&value));
    }
    page.push_str("</tbody></table>\n</section>\n");
}
