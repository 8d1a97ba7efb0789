//! Makes the batch, runs it, and tells what came of it.

use crate::batch::improvement::BestDurations;
use crate::batch::report::write_report;
use crate::batch::{Batch, BatchError, Entry, Row, Suite, Table, write_ompl_log};
use crate::cli::commands::bench::arguments::Arguments;
use crate::cli::commands::bench::progress::Shown;
use crate::cli::commands::bench::text;
use crate::cli::console::print::{Ending, Refusal, print, print_json, say};
use crate::cli::console::{interrupt, loading, outputs};
use crate::scene::PackagePath;
use std::time::Instant;

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let suite = arguments.suite()?;
    let best = arguments.best.as_deref().map_or_else(|| Ok(BestDurations::default()), BestDurations::read);
    let best = best.map_err(refused)?;
    outputs::check([], arguments.ompl_log.iter().chain(&arguments.report))?;
    let entries = match entries(&suite, arguments, packages)? {
        Ok(entries) => entries,
        Err(ending) => return Ok(ending),
    };
    let shown = Shown::new(arguments.json);
    let token = interrupt::token();
    let batch = suite.batch(entries, packages).map_err(refused)?.best(best).cancelled_by(token.clone());
    let batch = options(batch, arguments, &shown);
    let solves = batch.solves();
    let tell = |row: &Row| shown.row(row);
    let rows = match arguments.resume {
        true => batch.resume(&arguments.out, tell),
        false => batch.run(&arguments.out, tell),
    };
    shown.finish();
    let rows = rows.map_err(refused)?;
    shown.sum().iter().for_each(|sum| say(sum));
    if let (Some((recorded, failed)), Some(folder)) = (batch.failures_recorded(), &arguments.record_failures) {
        say(&format!("{recorded} of {failed} failed solves are recorded in {}\n", folder.display()));
    }
    let table = batch.table(&rows);
    match arguments.json {
        true => print_json(&text::object(&table, &rows))?,
        false => print(&format!("\n{}", table.markdown())),
    }
    write(arguments, &suite.name, &table, &rows)?;
    if token.is_cancelled() && rows.len() < solves {
        say(&format!("interrupted after {} of {solves} solves; --resume goes on\n", rows.len()));
        return Ok(Ending::Interrupted);
    }
    Ok(if rows.iter().all(Row::is_solved) { Ending::Done } else { Ending::Failed })
}

/// The problems, all loaded before anything is solved; or how the command ends where loading was cut off.
fn entries(
    suite: &Suite,
    arguments: &Arguments,
    packages: &PackagePath,
) -> Result<Result<Vec<Entry>, Ending>, Refusal> {
    let mut entries = Vec::with_capacity(suite.scenes.len());
    for name in &suite.scenes {
        let started = Instant::now();
        let entry = match loading::entry(name, packages, suite.time_limit)? {
            Ok(entry) => entry,
            Err(cut) => return Ok(Err(cut.tell(name, started.elapsed(), arguments.json)?)),
        };
        for warning in entry.scene().into_iter().flat_map(|scene| &scene.warnings) {
            say(&format!("warning: {warning}\n"));
        }
        entries.push(entry);
    }
    Ok(Ok(entries))
}

fn options(batch: Batch, arguments: &Arguments, shown: &Shown) -> Batch {
    let batch = match arguments.tuning.memory {
        Some(limit) => batch.memory_limit(limit),
        None => batch,
    };
    let batch = match &arguments.record_failures {
        Some(folder) => batch.record_failures(folder.clone()),
        None => batch,
    };
    let batch = match arguments.shard {
        Some(shard) => batch.shard(shard),
        None => batch,
    };
    match shown.watcher() {
        Some(watcher) => batch.on_progress(watcher),
        None => batch,
    }
}

/// Writes what else is asked for.
fn write(arguments: &Arguments, name: &str, table: &Table, rows: &[Row]) -> Result<(), Refusal> {
    if let Some(file) = &arguments.ompl_log {
        for written in write_ompl_log(file, table, rows).map_err(refused)? {
            say(&format!("log of OMPL's benchmarks: {}\n", written.display()));
        }
    }
    if let Some(file) = &arguments.report {
        write_report(file, name, table, rows).map_err(refused)?;
        say(&format!("report: {}\n", file.display()));
    }
    Ok(())
}

fn refused(error: BatchError) -> Refusal {
    Refusal(error.to_string())
}
