//! Rows as a log of OMPL's benchmarks (`ompl::tools::Benchmark`), for `ompl_benchmark_statistics.py` and Planner Arena.
//!
//! A log has one experiment: a scene. What OMPL calls a planner is a scheduler with settings, a run is a row.

use crate::batch::entry::as_file_name;
use crate::batch::error::{BatchError, write_whole};
use crate::batch::results::row::{PathNumbers, Row, RowOutcome, Work};
use crate::batch::results::table::Table;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The values of the property `status`, in OMPL's order.
const STATUSES: [&str; 10] = [
    "Unknown status",
    "Invalid start",
    "Invalid goal",
    "Unrecognized goal type",
    "Timeout",
    "Approximate solution",
    "Exact solution",
    "Crash",
    "Abort",
    "Infeasible",
];

/// What a run says, by name and type.
const PROPERTIES: [&str; 12] = [
    "time REAL",
    "solved BOOLEAN",
    "status ENUM",
    "seed INTEGER",
    "iterations INTEGER",
    "graph states INTEGER",
    "graph motions INTEGER",
    "solution segments INTEGER",
    "solution length REAL",
    "solution clearance REAL",
    "solution duration REAL",
    "best cost REAL",
];

/// Writes the rows of a batch as logs of OMPL's benchmarks. With one scene the log is `file`, with several there is one for each, whose name has
/// that of the scene before its extension. Says which were written.
///
/// # Errors
/// A file that cannot be written.
pub fn write_ompl_log(file: &Path, table: &Table, rows: &[Row]) -> Result<Vec<PathBuf>, BatchError> {
    let mut written = Vec::new();
    for scene in &table.scenes {
        let path = if table.scenes.len() == 1 { file.to_owned() } else { beside(file, &scene.scene) };
        write_whole(&path, &log(&scene.scene, table, rows))?;
        written.push(path);
    }
    Ok(written)
}

/// `runs.log` of a scene: `runs-SCENE.log`.
fn beside(file: &Path, scene: &str) -> PathBuf {
    let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let extension = file.extension().map(|ending| format!(".{}", ending.to_string_lossy())).unwrap_or_default();
    file.with_file_name(format!("{stem}-{}{extension}", as_file_name(scene)))
}

/// The log of one scene.
fn log(scene: &str, table: &Table, rows: &[Row]) -> String {
    let rows: Vec<&Row> = rows.iter().filter(|row| row.scene == scene).collect();
    let mut planners: Vec<(&str, &str)> = Vec::new();
    for row in &rows {
        let planner = (row.scheduler.as_str(), row.settings.as_str());
        if !planners.contains(&planner) {
            planners.push(planner);
        }
    }
    let most = planners.iter().map(|planner| runs(&rows, *planner).count()).max().unwrap_or(0);
    let total: f64 = rows.iter().map(|row| row.solve_time.as_secs_f64()).sum();
    let mut out = String::new();
    // Names are one word: readers take the last one of a line.
    let _ = writeln!(out, "foliate version {}", env!("CARGO_PKG_VERSION"));
    let _ = writeln!(out, "Experiment {}", as_file_name(scene));
    let _ = writeln!(out, "Running on {}", host());
    let _ = writeln!(out, "Starting at {}", table.date);
    let _ = writeln!(
        out,
        "<<<|\nscene {}, seeds {}, threads in all: {}\n|>>>",
        one_line(scene),
        table.seeds,
        table.threads
    );
    let _ = writeln!(out, "<<<|\n{}\n|>>>", table.machine);
    let _ = writeln!(out, "{} is the random seed", table.seeds.first());
    let _ = writeln!(out, "{} seconds per run", table.time_limit.as_secs_f64());
    let _ = writeln!(out, "{} MB per run", table.search.max_bytes >> 20);
    let _ = writeln!(out, "{most} runs per planner");
    let _ = writeln!(out, "{total} seconds spent to collect the data");
    let _ = writeln!(out, "1 enum type\nstatus|{}", STATUSES.join("|"));
    let _ = writeln!(out, "{} planners", planners.len());
    for planner in planners {
        let runs: Vec<&Row> = runs(&rows, planner).collect();
        write_planner(&mut out, planner, &runs);
    }
    out
}

fn runs<'a>(rows: &'a [&'a Row], planner: (&'a str, &'a str)) -> impl Iterator<Item = &'a Row> {
    rows.iter().copied().filter(move |row| (row.scheduler.as_str(), row.settings.as_str()) == planner)
}

fn write_planner(out: &mut String, (scheduler, settings): (&str, &str), runs: &[&Row]) {
    let name = if settings.is_empty() { scheduler.to_owned() } else { format!("{scheduler}_{settings}") };
    let _ = writeln!(out, "foliate_{}", as_file_name(&name));
    let threads = runs.first().map_or(1, |row| row.threads);
    let _ = writeln!(out, "1 common properties\nthreads = {threads}");
    let _ = writeln!(out, "{} properties for each run\n{}", PROPERTIES.len(), PROPERTIES.join("\n"));
    let _ = writeln!(out, "{} runs", runs.len());
    for row in runs {
        let _ = writeln!(out, "{}; ", values(row).join("; "));
    }
    let histories = runs.iter().map(|row| Some(&row.answer.as_ref()?.improvement.as_ref()?.history));
    if histories.clone().any(|history| history.is_some_and(|history| !history.is_empty())) {
        let _ = writeln!(out, "2 progress properties for each run\ntime REAL\nbest cost REAL\n{} runs", runs.len());
        for history in histories {
            for cost in history.into_iter().flatten() {
                let _ = write!(out, "{},{},;", cost.time.as_secs_f64(), cost.cost);
            }
            out.push('\n');
        }
    }
    out.push_str(".\n");
}

/// The values of [`PROPERTIES`]; what a run does not have is empty.
fn values(row: &Row) -> [String; PROPERTIES.len()] {
    let work = |value: fn(&Work) -> String| row.work.as_ref().map(value).unwrap_or_default();
    let path = |value: fn(&PathNumbers) -> String| row.path.as_ref().map(value).unwrap_or_default();
    let improvement = row.answer.as_ref().and_then(|answer| answer.improvement.as_ref());
    [
        row.solve_time.as_secs_f64().to_string(),
        u8::from(row.is_solved()).to_string(),
        status(row.outcome).to_string(),
        row.seed.to_string(),
        work(|work| work.candidates.to_string()),
        work(|work| work.nodes.to_string()),
        work(|work| work.edges.to_string()),
        path(|path| path.segments.to_string()),
        path(|path| path.length.to_string()),
        path(|path| path.min_clearance.map(|clearance| clearance.to_string()).unwrap_or_default()),
        row.answer.as_ref().and_then(|answer| answer.duration).map(|time| time.to_string()).unwrap_or_default(),
        improvement.map(|improvement| improvement.final_cost.to_string()).unwrap_or_default(),
    ]
}

/// The number of the status that OMPL would give.
fn status(outcome: RowOutcome) -> usize {
    match outcome {
        RowOutcome::Solved => 6,
        RowOutcome::Timeout | RowOutcome::StepLimit => 4,
        RowOutcome::InfeasibleStart | RowOutcome::NoInstance => 1,
        RowOutcome::InfeasibleGoal => 2,
        RowOutcome::Crashed => 7,
        RowOutcome::Cancelled | RowOutcome::MemoryLimit => 8,
        RowOutcome::Failed => 0,
    }
}

/// The machine's name, where the system tells it.
fn host() -> String {
    let told = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let name = as_file_name(told.trim());
    if name.is_empty() { "unknown".into() } else { name }
}

fn one_line(text: &str) -> String {
    text.escape_debug().to_string()
}
