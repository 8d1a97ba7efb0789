//! Promise: a suite file says what a batch solves; its mistakes are told with file and line. Rows have identities that do not depend on how a batch
//! is cut into parts, on threads or on the order in which it is solved. Logs for OMPL's programs say what the rows say.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

#[path = "common/skip.rs"]
mod skip;

use foliate::batch::vary::Variations;
use foliate::batch::{Batch, BatchError, COLUMNS, Entry, Row, Seeds, Settings, Shard, Suite, Variant};
use foliate::components::samples::move_one_box;
use foliate::scene::PackagePath;
use foliate::schedulers;
use foliate::systems::settings::SearchSettings;
use skip::{Needs, skipped};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// A fresh folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-suites-{name}-{}", std::process::id()));
        let _fresh = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }

    fn at(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

fn foliate(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_foliate")).args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn told(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat()
}

const SUITE: &str = r#"format = "foliate.suite/1"
name = "small"
scenes = ["demo"]
schedulers = ["sequence", "mrrt"]
seeds = "1..2"
time_limit = 50

[[settings]]
name = "usual"

[[settings]]
name = "wide"
candidates = 32
selection = "leaf-first"
loop_weight = 0.5
threads = 2
"#;

/// Rows of a `results.csv` as cells by column, times and load left out.
fn rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(head, COLUMNS);
    let row = |line: &str| {
        let cells = line.split(',').map(str::to_owned);
        let named = head.iter().map(|name| (*name).to_owned()).zip(cells);
        named.filter(|(name, _)| !name.ends_with("_ms")).collect()
    };
    lines.map(row).collect()
}

#[test]
fn a_suite_solves_every_scene_with_all_schedulers_and_settings() {
    let folder = Folder::new("all");
    let suite = folder.write("suite.toml", SUITE);
    let bench = |out: &str, more: &[&str]| {
        let output = foliate(&[&["bench", "--suite", &suite, "--out", &folder.at(out)], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", told(&output));
        told(&output)
    };
    let text = bench("one", &[]);
    for line in ["| demo | sequence | usual | 2/2 |", "| demo | mrrt | wide | 2/2 |"] {
        assert!(text.contains(line), "{text}");
    }
    let whole = rows(&folder.text("one/results.csv"));
    let label =
        |row: &BTreeMap<String, String>| ["scheduler", "settings", "seed", "threads"].map(|key| row[key].clone());
    let labels: Vec<_> = whole.iter().map(label).collect();
    assert_eq!(labels[0], ["sequence", "usual", "1", "1"]);
    assert_eq!(labels[7], ["mrrt", "wide", "2", "2"]);
    assert_eq!(labels.iter().collect::<BTreeSet<_>>().len(), 8);
    assert_eq!(whole.iter().map(|row| &row["id"]).collect::<BTreeSet<_>>().len(), 8);
    assert!(folder.0.join("one/paths/demo-mrrt-wide-2.json").is_file());

    // Parts: each row is in one of them, and is the same there.
    let mut parts = Vec::new();
    for part in 1..=3 {
        let out = format!("part{part}");
        bench(&out, &["--shard", &format!("{part}/3"), "--threads", "3", "--no-paths"]);
        assert!(std::fs::read_dir(folder.0.join(&out).join("paths")).unwrap().next().is_none());
        parts.extend(rows(&folder.text(&format!("{out}/results.csv"))));
    }
    let sorted = |mut rows: Vec<BTreeMap<String, String>>| {
        rows.sort_by_key(|row| row["id"].clone());
        rows
    };
    assert_eq!(sorted(parts), sorted(whole));

    // A finished batch has nothing left to solve, and another suite is another batch.
    let again = foliate(&["bench", "--suite", &suite, "--out", &folder.at("one"), "--resume"]);
    assert!(!String::from_utf8_lossy(&again.stderr).contains("solved in"), "{}", told(&again));
    folder.write("suite.toml", &SUITE.replace("candidates = 32", "candidates = 33"));
    let other = foliate(&["bench", "--suite", &suite, "--out", &folder.at("one"), "--resume"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(told(&other).contains("were made with settings wide = "), "{}", told(&other));
}

#[test]
fn mistakes_are_told_with_file_line_and_a_way_out() {
    let folder = Folder::new("mistakes");
    let cases = [
        ("format = \"foliate.suite/1\"", "format = \"foliate.scene/1\"", 1, "is no format of suites"),
        ("seeds = ", "seed = ", 5, "is no key of a suite file (did you mean `seeds`?)"),
        ("candidates = 32", "candidate = 32", 13, "did you mean `candidates`?"),
        ("candidates = 32", "candidates = 0", 13, "wants a whole number from 1 to 4096, got 0"),
        ("candidates = 32", "candidates = 1.5", 13, "wants a whole number"),
        ("\"leaf-first\"", "\"leaf_first\"", 14, "did you mean `leaf-first`?"),
        ("\"mrrt\"", "\"mrtt\"", 4, "did you mean `mrrt`?"),
        ("\"mrrt\"", "\"sequence\"", 4, "is given twice"),
        ("seeds = \"1..2\"", "seeds = \"2..1\"", 5, "is no range of seeds"),
        ("time_limit = 50", "time_limit = -1", 6, "is negative"),
        ("time_limit = 50", "checkpoints = [1]", 6, "give `improve_work` or `improve_time`"),
        ("name = \"wide\"", "name = \"a/b\"", 12, "has other characters"),
        ("scenes = [\"demo\"]", "scenes = []", 3, "0 are given"),
        ("threads = 2", "threads = 2\n[vary]\nseed = 1", 17, "key `instances` is missing"),
        (
            "threads = 2",
            "threads = 2\n[vary]\ninstances = 1\n[[vary.move]]\npart = \"table\"\nx = [2, 1]",
            21,
            "above the upper bound",
        ),
    ];
    for (before, after, line, says) in cases {
        let suite = folder.write("suite.toml", &SUITE.replacen(before, after, 1));
        let output = foliate(&["bench", "--suite", &suite, "--out", &folder.at("out")]);
        let text = told(&output);
        assert_eq!(output.status.code(), Some(2), "{after}: {text}");
        assert!(text.contains(&format!("suite.toml:{line}: ")) && text.contains(says), "{after}: {text}");
    }
    // What only the scene can tell, and options that a suite says.
    let refusals = [
        ("starts = [\"table\"]", "vary.starts: `table` is no object that lies on a support"),
        ("objects = [1, 9]", "vary.objects: is up to 9, the scene has 2 movable objects"),
        ("[[vary.size]]\npart = \"box1\"\nfactor = [1, 2]", "vary.size: `box1` is no part with a `shape`"),
        ("[[vary.move]]\npart = \"tabel\"", "did you mean `table`?"),
    ];
    for (vary, says) in refusals {
        let suite = folder.write("suite.toml", &format!("{SUITE}\n[vary]\ninstances = 2\n{vary}"));
        let text = told(&foliate(&["bench", "--suite", &suite, "--out", &folder.at("out")]));
        assert!(text.contains(says), "{text}");
    }
    let suite = folder.write("suite.toml", SUITE);
    for more in
        [&["--seeds", "1..3"][..], &["demo"], &["--time-limit", "3"], &["--improve-work", "3"], &["--best", "x.csv"]]
    {
        let output = foliate(&[&["bench", "--suite", &suite, "--out", &folder.at("out")], more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}: {}", told(&output));
    }
    let few = foliate(&["bench", "--suite", &suite, "--threads", "1", "--out", &folder.at("out")]);
    assert!(told(&few).contains("`wide` use 2 threads, and the batch has 1"), "{}", told(&few));
    assert!(!folder.0.join("out").exists());
}

fn settings(threads: usize) -> Settings {
    Settings {
        seeds: Seeds::new(1, 3).unwrap(),
        threads,
        time_limit: Duration::from_secs(60),
        search: SearchSettings::default(),
        improvement: None,
    }
}

fn batch(threads: usize) -> Batch {
    Batch::new(vec![Entry::of_problem(move_one_box().unwrap()).unwrap()], settings(threads)).unwrap()
}

#[test]
fn identities_are_those_of_what_is_solved() {
    let folder = Folder::new("ids");
    let ids = |batch: Batch, out: &str| -> Vec<String> {
        batch.run(&folder.0.join(out), |_| {}).unwrap().into_iter().map(|row| row.id).collect()
    };
    let plain = ids(batch(1), "plain");
    assert_eq!(plain, ids(batch(3), "threads"));
    // More seeds, another scheduler beside the first, other names: the same solves keep their identities.
    let named = vec![Variant::new("usual", SearchSettings::default())];
    let both = vec![schedulers::named("mrrt").unwrap().into(), schedulers::named("sequence").unwrap().into()];
    let more = ids(batch(2).schedulers(both).unwrap().variants(named).unwrap(), "more");
    assert_eq!((more.len(), &more[3..]), (6, &plain[..]));
    // What decides the solve decides the identity.
    let wide = Variant::new("wide", SearchSettings::default().with(|s| s.candidates = 17));
    let other = ids(batch(1).variants(vec![wide]).unwrap(), "wide");
    let limited = Settings { time_limit: Duration::from_secs(59), ..settings(1) };
    let limited = Batch::new(vec![Entry::of_problem(move_one_box().unwrap()).unwrap()], limited).unwrap();
    let limited = ids(limited, "limited");
    assert!(plain.iter().all(|id| !other.contains(id) && !limited.contains(id)));
}

#[test]
fn batches_that_could_not_tell_their_rows_apart_are_refused() {
    let same = || SearchSettings::default();
    let named = |name: &str| schedulers::named(name).unwrap().into();
    let twice = batch(1).schedulers(vec![named("mrrt"), named("mrrt")]);
    assert!(matches!(twice, Err(BatchError::SameScheduler(_))));
    let variants = |list: Vec<Variant>| batch(1).variants(list).map(drop).unwrap_err();
    let equal = variants(vec![Variant::new("a", same()), Variant::new("b", same())]);
    assert!(matches!(equal, BatchError::EqualSettings(..)), "{equal}");
    let wide = SearchSettings::default().with(|s| s.candidates = 17);
    let same_name = variants(vec![Variant::new("a", same()), Variant::new("a", wide)]);
    assert!(matches!(same_name, BatchError::SameSettings(_)), "{same_name}");
    let many = variants(vec![Variant { threads: 2, ..Variant::new("a", same()) }]);
    assert!(matches!(many, BatchError::Oversubscribed { .. }), "{many}");
}

#[test]
fn an_interrupted_part_goes_on() {
    let folder = Folder::new("part");
    let shard: Shard = "1/2".parse().unwrap();
    let part = || batch(2).variants(vec![Variant::new("usual", SearchSettings::default())]).unwrap().shard(shard);
    let rows = part().run(&folder.0, |_| {}).unwrap();
    assert_eq!(part().solves(), rows.len());
    let text = folder.text("results.csv");
    // As if it had been cut before its last row.
    let last = text.trim_end().rfind('\n').unwrap() + 1;
    std::fs::write(folder.0.join("results.csv"), &text[..last]).unwrap();
    let again = std::sync::Mutex::new(Vec::new());
    let resumed = part().resume(&folder.0, |row: &Row| again.lock().unwrap().push(row.id.clone())).unwrap();
    assert_eq!(*again.lock().unwrap(), [rows.last().unwrap().id.clone()]);
    assert_eq!(
        resumed.iter().map(|row| &row.id).collect::<Vec<_>>(),
        rows.iter().map(|row| &row.id).collect::<Vec<_>>()
    );
    let other = batch(2).shard("2/2".parse().unwrap()).resume(&folder.0, |_| {}).unwrap_err();
    assert!(matches!(other, BatchError::Different { .. }), "{other}");
}

/// What a log of OMPL's benchmarks says, read as its grammar has it.
struct OmplLog {
    experiment: String,
    statuses: Vec<String>,
    planners: Vec<OmplPlanner>,
}

struct OmplPlanner {
    name: String,
    properties: Vec<String>,
    /// Values by run.
    runs: Vec<Vec<Option<f64>>>,
    /// Times and costs by run.
    progress: Vec<Vec<(f64, f64)>>,
}

impl OmplLog {
    fn read(text: &str) -> Self {
        let mut lines = text.lines();
        let mut next = || lines.next().unwrap_or_else(|| panic!("the log ends early"));
        let after = |line: &str, start: &str| line.strip_prefix(start).unwrap_or_else(|| panic!("{line}")).to_owned();
        let before =
            |line: &str, end: &str| line.strip_suffix(end).unwrap_or_else(|| panic!("{line}: {end}")).to_owned();
        assert!(next().contains(" version "));
        let experiment = after(next(), "Experiment ");
        after(next(), "Running on ");
        after(next(), "Starting at ");
        for _ in 0..2 {
            assert_eq!(next(), "<<<|");
            while next() != "|>>>" {}
        }
        before(next(), " is the random seed").parse::<u64>().unwrap();
        before(next(), " seconds per run").parse::<f64>().unwrap();
        before(next(), " MB per run").parse::<f64>().unwrap();
        let most: usize = before(next(), " runs per planner").parse().unwrap();
        before(next(), " seconds spent to collect the data").parse::<f64>().unwrap();
        assert_eq!(next(), "1 enum type");
        let statuses = after(next(), "status|").split('|').map(str::to_owned).collect();
        let count: usize = before(next(), " planners").parse().unwrap();
        let mut planners = Vec::new();
        for _ in 0..count {
            let name = next().to_owned();
            let common: usize = before(next(), " common properties").parse().unwrap();
            (0..common).for_each(|_| assert!(next().contains(" = ")));
            let count: usize = before(next(), " properties for each run").parse().unwrap();
            let properties: Vec<String> = (0..count).map(|_| next().rsplit_once(' ').unwrap().0.to_owned()).collect();
            let count: usize = before(next(), " runs").parse().unwrap();
            assert!(count <= most);
            let number = |cell: &str| if cell.is_empty() { None } else { Some(cell.parse::<f64>().unwrap()) };
            let run = |line: &str| {
                let cells: Vec<&str> = line.split("; ").collect();
                assert_eq!((cells.len(), *cells.last().unwrap()), (properties.len() + 1, ""));
                cells[..properties.len()].iter().map(|cell| number(cell)).collect()
            };
            let runs: Vec<Vec<Option<f64>>> = (0..count).map(|_| run(next())).collect();
            let mut progress = Vec::new();
            if next() != "." {
                assert_eq!([next(), next()], ["time REAL", "best cost REAL"]);
                assert_eq!(before(next(), " runs").parse(), Ok(count));
                let sample = |text: &str| {
                    let (time, cost) =
                        before(text, ",").split_once(',').map(|(t, c)| (t.to_owned(), c.to_owned())).unwrap();
                    (time.parse().unwrap(), cost.parse().unwrap())
                };
                let series = |line: &str| line.split(';').filter(|text| !text.is_empty()).map(sample).collect();
                progress = (0..count).map(|_| series(next())).collect();
                assert_eq!(next(), ".");
            }
            planners.push(OmplPlanner { name, properties, runs, progress });
        }
        assert_eq!(lines.next(), None);
        Self { experiment, statuses, planners }
    }
}

#[test]
fn logs_for_ompls_programs_say_what_the_rows_say() {
    let folder = Folder::new("ompl");
    let suite = SUITE.replace("time_limit = 50", "time_limit = 50\nimprove_work = 300");
    let suite = folder.write("suite.toml", &suite.replace("threads = 2", "max_steps = 1"));
    let log = folder.at("runs.log");
    let output = foliate(&["bench", "--suite", &suite, "--out", &folder.at("out"), "--ompl-log", &log]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    let rows = rows(&folder.text("out/results.csv"));
    let log = OmplLog::read(&folder.text("runs.log"));
    assert_eq!(log.experiment, "demo");
    let names: Vec<_> = log.planners.iter().map(|planner| planner.name.as_str()).collect();
    assert_eq!(names, ["foliate_sequence_usual", "foliate_sequence_wide", "foliate_mrrt_usual", "foliate_mrrt_wide"]);
    let mut all = rows.iter();
    for OmplPlanner { properties, runs, progress, .. } in &log.planners {
        let column = |name: &str| properties.iter().position(|property| property == name).unwrap();
        assert_eq!(runs.len(), 2);
        for (number, run) in runs.iter().enumerate() {
            let row = all.next().unwrap();
            let expected = if row["outcome"] == "solved" { "Exact solution" } else { "Timeout" };
            assert_eq!(log.statuses[run[column("status")].unwrap() as usize], expected);
            assert_eq!(run[column("solved")], Some(f64::from(u8::from(row["outcome"] == "solved"))));
            for (property, cell) in [
                ("seed", "seed"),
                ("graph states", "nodes"),
                ("best cost", "final_cost"),
                ("solution length", "path_length"),
            ] {
                assert_eq!(run[column(property)], row[cell].parse().ok(), "{property}");
            }
            let last = progress.get(number).and_then(|series| series.last()).map(|(_, cost)| *cost);
            assert_eq!(last, row["final_cost"].parse().ok());
        }
    }
    // One log for each of several scenes.
    let logs = folder.at("both.log");
    let out = folder.at("both");
    let output =
        foliate(&["bench", "demo", "stack", "--seeds", "1", "--time-limit", "20", "--out", &out, "--ompl-log", &logs]);
    assert!(output.status.code().is_some_and(|code| code < 2), "{}", told(&output));
    assert_eq!(OmplLog::read(&folder.text("both-stack.log")).experiment, "stack");
    assert!(folder.0.join("both-demo.log").is_file() && !folder.0.join("both.log").exists());
}

#[test]
fn a_terminal_shows_a_bar_and_what_was_not_solved() {
    let folder = Folder::new("bar");
    let program = env!("CARGO_BIN_EXE_foliate");
    let suite = |name: &str, steps: u32| {
        let text = SUITE.split_once("[[settings]]").unwrap().0.replace(", \"mrrt\"", "");
        folder.write(name, &format!("{text}[[settings]]\nname = \"x\"\nmax_steps = {steps}\n"))
    };
    let run = |suite: String, out: &str| {
        let command = format!("'{program}' bench --suite '{suite}' --out '{}'", folder.at(out));
        Command::new("script").args(["-qec", &command, "/dev/null"]).stdin(Stdio::null()).output()
    };
    let Ok(output) = run(suite("good.toml", 0), "good") else {
        skipped(Needs::System, "a_terminal_shows_a_bar_and_what_was_not_solved", "script (util-linux) is not there");
        return;
    };
    let text = told(&output);
    assert!(text.contains("of 2, ") && text.contains("rows/s") && text.contains("2 rows: 2 solved, 0 not"), "{text}");
    assert!(!text.contains("solved in"), "{text}");
    let text = told(&run(suite("bad.toml", 1), "bad").unwrap());
    assert!(text.contains("demo (sequence x) 1: step_limit in"), "{text}");
    assert!(text.contains("2 rows: 0 solved, 2 not"), "{text}");
}

#[test]
fn relative_scenes_start_at_the_suite() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let text = "format = \"foliate.suite/1\"\nname = \"x\"\nscenes = [\"demo\", \"stack/scene.toml\"]\n";
    let suite = Suite::from_text("x", text, &directory).unwrap();
    assert_eq!(suite.scenes, ["demo".to_owned(), directory.join("stack/scene.toml").display().to_string()]);
    assert_eq!(
        (suite.seeds.to_string(), suite.threads, suite.schedulers),
        ("1..20".into(), 1, vec!["sequence".to_owned()])
    );
}

#[test]
fn the_page_of_suites_is_true() {
    let page = include_str!("../docs/batches.md");
    let example = page.split_once("```toml\n").unwrap().1.split_once("```").unwrap().0;
    let suite = Suite::from_text("example", example, Path::new(".")).unwrap_or_else(|error| panic!("{error}"));
    let vary = suite.vary.unwrap();
    assert_eq!((suite.settings.len(), suite.settings[1].search.candidates, suite.settings[1].threads), (2, 32, 2));
    assert_eq!((vary.instances, vary.objects, vary.moves.len(), suite.paths), (100, Some((1, 2)), 1, false));
    let tables = page.replacen(example, "", 1);
    let keys = "format name scenes schedulers settings seeds time_limit threads improve_work improve_time checkpoints paths vary candidates \
                selection loop_weight max_steps simd instances seed tries starts goals any_face within objects move size obstacles part factor count \
                sides x y z turn";
    for key in keys.split_whitespace() {
        assert!(tables.contains(&format!("`{key}`")), "`{key}` is not described");
    }
    for column in COLUMNS {
        let is_told = tables.contains(&format!("`{column}`"))
            || ["first_cost", "final_cost", "duration", "improve_work", "improve_ms", "timing_ms"].contains(&column);
        assert!(is_told, "the column `{column}` is not described");
    }
    // Its scene has what it varies.
    let entry = Entry::load("demo", &PackagePath::default()).unwrap();
    Variations::new(&entry, vary, &PackagePath::default()).unwrap();
}
