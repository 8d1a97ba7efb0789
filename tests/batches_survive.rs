//! A batch has a row for every solve, whatever happens to it, and rows do not depend on how many solves run side by side.
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

use bevy_ecs::prelude::{Res, Schedule, World};
use foliate::batch::{Batch, BatchError, COLUMNS, Entry, Row, Seeds, Settings};
use foliate::components::samples::{boxes_on_a_table, move_one_box};
use foliate::schedulers::{Scheduler, mrrt::Mrrt};
use foliate::systems::settings::SearchSettings;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// A fresh folder that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("foliate-batch-{name}-{}", std::process::id()));
        let _fresh = std::fs::remove_dir_all(&path);
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

/// Panics in the first step of seed 2.
struct Fragile;

impl Scheduler for Fragile {
    fn name(&self) -> &'static str {
        "fragile"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = Mrrt.schedule(world);
        schedule.add_systems(|settings: Res<'_, SearchSettings>| {
            assert_ne!(settings.seed, 2, "seed 2, of all \"seeds\"");
        });
        schedule
    }
}

fn settings(threads: usize, seconds: f64) -> Settings {
    Settings {
        seeds: Seeds::new(1, 4).unwrap(),
        threads,
        time_limit: Duration::from_secs_f64(seconds),
        search: SearchSettings::default(),
        improvement: None,
    }
}

fn batch(settings: Settings) -> Batch {
    Batch::new(vec![Entry::of_problem(move_one_box().unwrap()).unwrap()], settings).unwrap()
}

/// Everything but the times.
fn without_times(rows: &[Row]) -> Vec<Vec<String>> {
    let times: Vec<_> = COLUMNS.iter().map(|column| column.ends_with("_ms")).collect();
    let kept = |row: &Row| row.cells().into_iter().zip(&times).filter(|(_, time)| !**time).map(|(c, _)| c).collect();
    rows.iter().map(kept).collect()
}

#[test]
fn every_seed_has_its_row_and_threads_change_nothing_but_times() {
    let solve = |threads: usize| {
        let folder = Folder::new(&format!("threads-{threads}"));
        let batch = batch(settings(threads, 60.0));
        let rows = batch.run(&folder.0, |_| {}).unwrap();
        let written = std::fs::read_to_string(folder.0.join("results.csv")).unwrap();
        let lines: Vec<String> = std::iter::once(COLUMNS.join(",") + "\n").chain(rows.iter().map(Row::csv)).collect();
        assert_eq!(written, lines.concat());
        assert_eq!(std::fs::read_to_string(folder.0.join("table.md")).unwrap(), batch.table(&rows).markdown());
        assert!(batch.table(&rows).markdown().contains("| boxes on a table | 4/4 |"));
        rows
    };
    let (one, two) = (solve(1), solve(2));
    assert_eq!(one.iter().map(|row| row.seed).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert!(one.iter().all(Row::is_solved));
    assert!(one.iter().all(|row| row.path.is_some_and(|path| path.segments > 0 && path.length > 0.0)));
    assert_eq!(without_times(&one), without_times(&two));
}

#[test]
fn a_panic_is_a_row_and_stops_no_other_solve() {
    let folder = Folder::new("panic");
    let batch = batch(settings(2, 60.0)).scheduler(Arc::new(Fragile));
    let rows = batch.run(&folder.0, |_| {}).unwrap();
    let outcomes: Vec<_> = rows.iter().map(|row| (row.seed, row.outcome.name())).collect();
    assert_eq!(outcomes, [(1, "solved"), (2, "crashed"), (3, "solved"), (4, "solved")]);
    assert!(rows[1].message.contains("of all \"seeds\""), "{}", rows[1].message);
    assert!(rows[1].csv().contains("of all \"\"seeds\"\""));
    assert!(batch.table(&rows).markdown().contains("| 3/4 |"));
}

#[test]
fn a_deadline_is_a_row() {
    let folder = Folder::new("deadline");
    let rows = batch(settings(1, 0.0)).run(&folder.0, |_| {}).unwrap();
    assert_eq!(rows.len(), 4);
    assert!(rows.iter().all(|row| row.outcome.name() == "timeout" && row.path.is_none()));
}

#[test]
fn an_infeasible_start_is_a_row_with_its_reason() {
    let folder = Folder::new("infeasible");
    // Two boxes in the same place.
    let problem = boxes_on_a_table(&[(0.6, 0.1), (0.6, 0.1)], &[(0.6, 0.1), (0.6, -0.1)]).unwrap();
    let batch = Batch::new(vec![Entry::of_problem(problem).unwrap()], settings(1, 60.0)).unwrap();
    let rows = batch.run(&folder.0, |_| {}).unwrap();
    assert!(rows.iter().all(|row| row.outcome.name() == "infeasible_start" && !row.message.is_empty()));
}

#[test]
fn results_are_not_written_over() {
    let folder = Folder::new("again");
    let batch = batch(settings(2, 0.0));
    batch.run(&folder.0, |_| {}).unwrap();
    assert!(matches!(batch.run(&folder.0, |_| {}), Err(BatchError::Exists { .. })));
}

#[test]
fn scenes_of_one_name_are_refused() {
    let entry = || Entry::of_problem(move_one_box().unwrap()).unwrap();
    assert!(matches!(Batch::new(vec![entry(), entry()], settings(1, 1.0)), Err(BatchError::SameName(_))));
}
