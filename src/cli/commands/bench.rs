//! `foliate bench`: many seeds of some scenes, a row each, and the table of the papers.

use crate::cli::commands::solve::arguments::{Tuning, deadline, no_scheduler};
use crate::cli::console::print::{Ending, Refusal, print, print_json, say};
use crate::cli::console::{interrupt, loading};
use foliate::batch::{Batch, Row, Seeds, Settings, Spread, Table};
use foliate::scene::PackagePath;
use foliate::schedulers;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Instant;

/// Solves scenes for many seeds and tabulates times and nodes
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
    /// Seconds after which one solve gives up. A scene is read once, and the time that this took counts for each of its solves; one
    /// that cannot be read within the limit ends the bench before anything is solved
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    time_limit: f64,
    /// Folder for results.csv, table.md and paths/; a new one, unless --resume is given
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Search scheduler; the default is the best over all shipped scenes, a name that does not exist lists all
    #[arg(long, default_value = schedulers::DEFAULT, value_name = "NAME")]
    scheduler: String,
    /// Go on with a folder in which the same bench was begun: rows that are there are kept
    #[arg(long)]
    resume: bool,
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
    };
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
    let refused = |error: foliate::batch::BatchError| Refusal(error.to_string());
    let batch = Batch::new(entries, settings).map_err(refused)?.scheduler(scheduler.into());
    let token = interrupt::token();
    let batch = batch.cancelled_by(token.clone());
    let batch = match arguments.tuning.memory {
        Some(limit) => batch.memory_limit(limit),
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

/// A row while the batch runs.
fn line(row: &Row) -> String {
    let nodes = row.work.map(|work| format!(", {} nodes", work.nodes)).unwrap_or_default();
    let why = if row.message.is_empty() { String::new() } else { format!(": {}", row.message.escape_debug()) };
    let (scene, seed, time) = (&row.scene, row.seed, row.solve_time.as_secs_f64());
    format!("{scene} {seed}: {} in {time:.3} s{nodes}{why}\n", row.outcome.name())
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
        "rows": rows.iter().map(Row::json).collect::<Vec<_>>(),
    })
}
