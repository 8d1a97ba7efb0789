//! `foliate bench`: many seeds of some scenes, a row each, and the table of the papers.

use crate::batch::improvement::{BestDurations, Budget, ImprovementTable, Measurement, Moment, SceneImprovement};
use crate::batch::{Batch, BatchError, Row, Seeds, Settings, Spread, Table};
use crate::cli::commands::solve::arguments::{BudgetArguments, INTERNALS, Tuning, deadline, no_scheduler};
use crate::cli::console::print::{Ending, Refusal, print, print_json, say};
use crate::cli::console::{interrupt, loading};
use crate::scene::PackagePath;
use crate::schedulers;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Solves scenes for many seeds and tabulates times and nodes
///
/// Measures the time to the first certified path, without improvement and times. With --improve-time or --improve-work each first path is
/// improved and timed as `solve` does it; times of first paths are measured as before, and how good paths are after how much time is
/// tabulated and drawn.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Shipped scenes' names, or scene files
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<String>,
    /// From A to B, both included: 1..20 are twenty seeds
    #[arg(long, default_value = "1..20", value_name = "A..B")]
    seeds: Seeds,
    /// Solves side by side; each of them uses one thread
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=512))]
    threads: u16,
    /// Seconds after which one solve gives up, improvement included. A scene is read once, and the time that this took counts for each
    /// of its solves; one that cannot be read within the limit ends the bench before anything is solved
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    time_limit: f64,
    /// Folder for results.csv, table.md and paths/, with an improvement also for improvement.csv, history.csv and plots/; a new one,
    /// unless --resume is given
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Search scheduler; the default is the best over all shipped scenes, a name that does not exist lists all
    #[arg(long, default_value = schedulers::DEFAULT, value_name = "NAME", hide = true, help_heading = INTERNALS)]
    scheduler: String,
    /// Go on with a folder in which the same bench was begun: rows that are there are kept
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    budget: BudgetArguments,
    /// Seconds of improvement after which the path is looked at, beside the first path and the end; those within the budget count
    #[arg(long, value_name = "S,S,...", value_delimiter = ',', requires = "BudgetArguments", value_parser = seconds)]
    #[arg(default_values = ["0.1", "1", "10"])]
    checkpoints: Vec<Duration>,
    /// improvement.csv of another run: its shortest durations are known too
    #[arg(long, value_name = "FILE.csv", requires = "BudgetArguments")]
    best: Option<PathBuf>,
    /// Record solves that find no path, as SCENE-SEED.search in this folder; the first hundred to end
    #[arg(long, value_name = "DIR")]
    record_failures: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) tuning: Tuning,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let settings = Settings {
        seeds: arguments.seeds,
        threads: usize::from(arguments.threads),
        time_limit: deadline(arguments.time_limit)?,
        search: arguments.tuning.settings(arguments.seeds.first()),
        improvement: measurement(arguments)?,
    };
    let best = arguments.best.as_deref().map_or_else(|| Ok(BestDurations::default()), BestDurations::read);
    let best = best.map_err(refused)?;
    let scheduler = schedulers::named(&arguments.scheduler).ok_or_else(|| no_scheduler(&arguments.scheduler))?;
    let mut entries = Vec::with_capacity(arguments.scenes.len());
    // All before anything is solved.
    for name in &arguments.scenes {
        let started = Instant::now();
        let entry = match loading::entry(name, packages, settings.time_limit)? {
            Ok(entry) => entry,
            Err(cut) => return cut.tell(name, started.elapsed(), arguments.json),
        };
        for warning in entry.scene().into_iter().flat_map(|scene| &scene.warnings) {
            say(&format!("warning: {warning}\n"));
        }
        entries.push(entry);
    }
    let batch = Batch::new(entries, settings).map_err(refused)?.scheduler(scheduler.into()).best(best);
    let token = interrupt::token();
    let batch = batch.cancelled_by(token.clone());
    let batch = match arguments.tuning.memory {
        Some(limit) => batch.memory_limit(limit),
        None => batch,
    };
    let batch = match &arguments.record_failures {
        Some(folder) => batch.record_failures(folder.clone()),
        None => batch,
    };
    let tell = |row: &Row| {
        if !arguments.json {
            say(&line(row));
        }
    };
    let rows = match arguments.resume {
        true => batch.resume(&arguments.out, tell),
        false => batch.run(&arguments.out, tell),
    };
    let rows = rows.map_err(refused)?;
    if let (Some((recorded, failed)), Some(folder)) = (batch.failures_recorded(), &arguments.record_failures) {
        say(&format!("{recorded} of {failed} failed solves are recorded in {}\n", folder.display()));
    }
    let table = batch.table(&rows);
    match arguments.json {
        true => print_json(&object(&table, &rows))?,
        false => print(&format!("\n{}", table.markdown())),
    }
    if token.is_cancelled() && rows.len() < batch.solves() {
        let (done, all) = (rows.len(), batch.solves());
        say(&format!("interrupted after {done} of {all} solves; --resume goes on\n"));
        return Ok(Ending::Interrupted);
    }
    Ok(if rows.iter().all(Row::is_solved) { Ending::Done } else { Ending::Failed })
}

fn refused(error: BatchError) -> Refusal {
    Refusal(error.to_string())
}

/// A number of seconds.
fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.trim().parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    seconds.ok_or_else(|| String::from("not a number of seconds"))
}

/// What is spent on better paths, where that is asked for.
fn measurement(arguments: &Arguments) -> Result<Option<Measurement>, Refusal> {
    let Some(budget) = arguments.budget.budget()? else { return Ok(None) };
    let limit = arguments.time_limit;
    if matches!(budget, Budget::Time(time) if time.as_secs_f64() >= limit) {
        return Err(Refusal(format!(
            "--improve-time does not fit into --time-limit {limit}, which holds for the search too"
        )));
    }
    Ok(Some(Measurement::new(budget).checkpoints(arguments.checkpoints.iter().copied())))
}

/// A row while the batch runs.
fn line(row: &Row) -> String {
    let nodes = row.work.map(|work| format!(", {} nodes", work.nodes)).unwrap_or_default();
    let why = if row.message.is_empty() { String::new() } else { format!(": {}", row.message.escape_debug()) };
    let (scene, seed, time) = (&row.scene, row.seed, row.solve_time.as_secs_f64());
    let answer = row.answer.as_ref().map(|answer| {
        let duration = answer.duration.map_or_else(|| "no times".into(), |duration| format!("{duration:.2} s"));
        format!("; {duration}, {} grasp changes", answer.grasp_changes)
    });
    format!("{scene} {seed}: {} in {time:.3} s{nodes}{}{why}\n", row.outcome.name(), answer.unwrap_or_default())
}

fn improvement(table: &ImprovementTable) -> Value {
    let moment = |m: &Moment| {
        let at = m.at.map(|at| at.as_secs_f64());
        json!({ "checkpoint": at, "shortest": m.shortest, "median": m.median, "longest": m.longest })
    };
    let scene = |s: &SceneImprovement| {
        json!({
            "scene": s.scene,
            "fewest_grasp_changes": s.fewest_grasp_changes,
            "grasp_ratios": s.grasp_ratios,
            "best_duration": s.best_duration,
            "durations": s.moments.iter().map(moment).collect::<Vec<_>>(),
        })
    };
    json!({
        "budget": table.measurement.budget().to_string(),
        "scenes": table.scenes.iter().map(scene).collect::<Vec<_>>(),
        "grasp_ratio_95": table.grasp_ratio_95(),
        "cut": table.cut,
        "untimed": table.untimed,
    })
}

fn object(table: &Table, rows: &[Row]) -> Value {
    let spread = |s: Option<Spread>| s.map(|s| json!({ "min": s.min, "median": s.median, "max": s.max }));
    let scenes: Vec<Value> = table
        .scenes
        .iter()
        .map(|s| {
            json!({
                "scene": s.scene,
                "solved": s.solved,
                "runs": s.runs,
                "time_s": spread(s.time),
                "nodes": spread(s.nodes),
            })
        })
        .collect();
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "machine": table.machine.to_string(),
        "date": table.date,
        "scheduler": table.scheduler,
        "simd": table.search.level.name(),
        "candidates": table.search.candidates,
        "selection": format!("{:?}", table.search.selection),
        "seeds": table.seeds.to_string(),
        "threads": table.threads,
        "time_limit_s": table.time_limit.as_secs_f64(),
        "scenes": scenes,
        "improvement": table.improvement.as_ref().map(improvement),
        "rows": rows.iter().map(Row::json).collect::<Vec<_>>(),
    })
}
