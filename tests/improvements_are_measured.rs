//! A batch that improves paths says what they are like over time, and measures first paths as a batch that does not.
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

use foliate::batch::improvement::{
    BestDurations, Budget, CHECKPOINT_COLUMNS, Checkpoint, HISTORY_COLUMNS, Measurement,
};
use foliate::batch::{Batch, COLUMNS, Entry, Row, Seeds, Settings};
use foliate::scene::PackagePath;
use foliate::systems::settings::SearchSettings;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A fresh folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-improvements-{name}-{}", std::process::id()));
        let _fresh = fs::remove_dir_all(&path);
        Self(path)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = fs::remove_dir_all(&self.0);
    }
}

/// The demo with three seeds.
fn batch(improvement: Option<Measurement>) -> Batch {
    let settings = Settings {
        seeds: Seeds::new(1, 3).unwrap(),
        threads: 2,
        time_limit: Duration::from_secs(600),
        search: SearchSettings::default(),
        improvement,
    };
    Batch::new(vec![Entry::load("demo", &PackagePath::default()).unwrap()], settings).unwrap()
}

/// By counted work: the same answers at any speed. The checkpoints lie so close, from 1 ms to 70 s, that on a slow or busy machine too
/// some are reached between the first better path and the end.
fn measurement() -> Measurement {
    let times = (0..44).map(|power| Duration::from_secs_f64(1e-3 * 1.3_f64.powi(power)));
    Measurement::new(Budget::Work(1500)).checkpoints(times)
}

fn checkpoints(row: &Row) -> &[Checkpoint] {
    &row.answer.as_ref().unwrap().improvement.as_ref().unwrap().checkpoints
}

/// The cells of a CSV without quotes.
fn cells(text: &str) -> Vec<Vec<&str>> {
    text.lines().map(|line| line.split(',').collect()).collect()
}

/// Duration of a path as its file has it: the last of all times.
fn written_duration(file: &Path) -> f64 {
    let path: serde_json::Value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
    let last =
        path["segments"].as_array().unwrap().last().unwrap()["times"].as_array().unwrap().last().unwrap().clone();
    last.as_f64().unwrap()
}

#[test]
fn paths_get_better_and_first_paths_stay_as_they_were() {
    let (folder, plain) = (Folder::new("whole"), Folder::new("plain"));
    let improving = batch(Some(measurement()));
    let rows = improving.run(&folder.0, |_| {}).unwrap();
    let first = batch(None).run(&plain.0, |_| {}).unwrap();
    assert!(!plain.0.join("improvement.csv").exists() && !plain.0.join("plots").exists());
    let column = |name: &str| COLUMNS.iter().position(|column| *column == name).unwrap();
    for (row, first) in rows.iter().zip(&first) {
        // What the search has done, and the length of its path.
        for name in ["scene", "seed", "outcome", "steps", "candidates", "nodes", "edges", "path_length", "roadmap"] {
            assert_eq!(row.cells()[column(name)], first.cells()[column(name)], "{name}");
        }
        assert!(first.cells()[column("grasp_changes")..].iter().all(String::is_empty));
        let answer = row.answer.as_ref().unwrap();
        let improvement = answer.improvement.as_ref().unwrap();
        assert!(improvement.final_cost < improvement.first_cost && improvement.work >= 1500, "{improvement:?}");
        let filled = &row.cells()[column("grasp_changes")..column("untimed")];
        assert!(filled.iter().all(|cell| !cell.is_empty()), "{filled:?}");
        // The path that is written is the answer.
        let file = folder.0.join(format!("paths/demo-{}.json", row.seed));
        assert!((written_duration(&file) - answer.duration.unwrap()).abs() < 1e-9);
        let [begin, .., end] = checkpoints(row) else { panic!("{:?}", checkpoints(row)) };
        assert_eq!((begin.at, begin.work, begin.cost), (Some(Duration::ZERO), 0, improvement.first_cost));
        assert_eq!((end.at, end.work, end.cost), (None, improvement.work, improvement.final_cost));
        assert_eq!((end.duration, end.grasp_changes), (answer.duration, answer.grasp_changes));
        assert!(end.duration.unwrap() < begin.duration.unwrap() && end.length > 0.0);
        for pair in checkpoints(row).windows(2) {
            assert!(pair[1].cost <= pair[0].cost && pair[1].work >= pair[0].work && pair[1].time > pair[0].time);
        }
        let costs =
            improvement.history.windows(2).all(|pair| pair[1].cost < pair[0].cost && pair[1].work > pair[0].work);
        assert!(costs && improvement.history.len() > 2);
    }
    assert!(rows.iter().any(|row| checkpoints(row).len() > 2), "no checkpoint was reached");

    // The files have what the rows have.
    let (improvement, history) = (folder.text("improvement.csv"), folder.text("history.csv"));
    assert_eq!(cells(&improvement)[0], CHECKPOINT_COLUMNS);
    assert_eq!(cells(&improvement).len(), 1 + rows.iter().map(|row| checkpoints(row).len()).sum::<usize>());
    assert_eq!(cells(&history)[0], HISTORY_COLUMNS);
    let table = improving.table(&rows).markdown();
    assert_eq!(folder.text("table.md"), table);
    assert!(table.contains("Improvement: work 1500 each") && table.contains("| median of scenes |"), "{table}");
}

/// The work at a checkpoint is a budget that gives the path of that checkpoint.
#[test]
fn a_checkpoint_is_the_answer_of_its_work() {
    let folder = Folder::new("work");
    let rows = batch(Some(measurement())).run(&folder.0, |_| {}).unwrap();
    let improving = |row: &Row| checkpoints(row).iter().rev().nth(1).filter(|row| row.work > 0).cloned();
    let (seed, checkpoint) = rows.iter().find_map(|row| Some((row.seed, improving(row)?))).unwrap();
    let shorter = Folder::new("shorter");
    let rows = batch(Some(Measurement::new(Budget::Work(checkpoint.work)))).run(&shorter.0, |_| {}).unwrap();
    let end = checkpoints(rows.iter().find(|row| row.seed == seed).unwrap()).last().unwrap();
    assert_eq!((end.cost, end.duration, end.work), (checkpoint.cost, checkpoint.duration, checkpoint.work));
    assert_eq!((end.grasp_changes, end.length), (checkpoint.grasp_changes, checkpoint.length));
}

#[test]
fn what_an_interruption_leaves_is_taken_up_once() {
    let folder = Folder::new("resume");
    let improving = batch(Some(measurement()));
    let rows = improving.run(&folder.0, |_| {}).unwrap();
    let names = ["results.csv", "improvement.csv", "history.csv"];
    let whole = names.map(|name| folder.text(name));
    let told = std::sync::Mutex::new(Vec::new());
    let resume = || {
        told.lock().unwrap().clear();
        let rows = improving.resume(&folder.0, |row| told.lock().unwrap().push(row.seed)).unwrap();
        let again = told.lock().unwrap().clone();
        (rows, again)
    };
    // Nothing is missing.
    let (same, again) = resume();
    assert_eq!((names.map(|name| folder.text(name)), again), (whole.clone(), vec![]));
    assert!(same.iter().zip(&rows).all(|(same, row)| checkpoints(same) == checkpoints(row)));
    // Killed before the row of the last seed was written, behind the rows that come before it; and half a row.
    let last = whole[0].trim_end().rfind('\n').unwrap() + 1;
    fs::write(folder.0.join("results.csv"), &whole[0][..last + 9]).unwrap();
    assert_eq!(resume().1, [3]);
    // A seed that has lost its last row of either file is solved again, and has all its rows once.
    for name in &names[1..] {
        let text = folder.text(name);
        let last = text.trim_end().rfind('\n').unwrap() + 1;
        fs::write(folder.0.join(name), &text[..last]).unwrap();
        let (rows, again) = resume();
        assert_eq!(again, [3], "{name}");
        let count = 1 + rows.iter().map(|row| checkpoints(row).len()).sum::<usize>();
        assert_eq!(folder.text("improvement.csv").lines().count(), count);
    }
    // First two seeds: not touched by any of this.
    let kept = |text: &str| -> Vec<String> {
        let is_kept = |line: &&str| ["demo,1,", "demo,2,"].iter().any(|head| line.starts_with(head));
        text.lines().filter(is_kept).map(String::from).collect()
    };
    assert_eq!(names.map(|name| kept(&folder.text(name))), whole.map(|text| kept(&text)));
    // Other measurements are other batches.
    let other = batch(Some(Measurement::new(Budget::Work(10)))).resume(&folder.0, |_| {}).unwrap_err();
    assert!(other.to_string().contains("improvement = work 1500, checkpoints 0.001 0.0013 "), "{other}");
    assert!(batch(None).resume(&folder.0, |_| {}).is_err());
}

#[test]
fn each_scene_has_a_picture_and_other_runs_know_better() {
    let folder = Folder::new("plots");
    let improving = batch(Some(measurement()));
    let rows = improving.run(&folder.0, |_| {}).unwrap();
    let svg = folder.text("plots/demo.svg");
    let picture = roxmltree::Document::parse(&svg).unwrap();
    let with = |class: &str| picture.descendants().filter(|node| node.attribute("class") == Some(class)).count();
    assert_eq!((with("median"), with("band")), (1, 1));
    let title = picture.descendants().find(|node| node.has_tag_name("title")).unwrap();
    assert_eq!(title.text(), Some("demo"));
    for label in ["estimated cost of the path (s)", "time of improvement after the first path (s), logarithmic"] {
        assert!(picture.descendants().any(|node| node.text() == Some(label)), "{label}");
    }

    let best = BestDurations::read(&folder.0.join("improvement.csv")).unwrap();
    let table = improving.table(&rows).improvement.unwrap();
    assert_eq!(best.0.get("demo").copied(), table.scenes[0].best_duration);
    let better = BestDurations([("demo".to_owned(), 0.5)].into());
    assert_eq!(improving.best(better).table(&rows).improvement.unwrap().scenes[0].best_duration, Some(0.5));
    assert!(BestDurations::read(&folder.0.join("results.csv")).is_err());
    assert!(BestDurations::read(&folder.0.join("missing.csv")).is_err());
}
