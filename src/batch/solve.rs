//! One solve of a batch, to its row and its path.

use crate::batch::entry::Entry;
use crate::batch::improvement::watch::Watch;
use crate::batch::record;
use crate::batch::record::FailureFolder;
use crate::batch::row::{PathNumbers, Row, RowOutcome, Work};
use crate::batch::settings::Settings;
use crate::os::memory::MemoryLimit;
use crate::path_file::error::PathFileError;
use crate::path_file::save;
use crate::path_file::write::{FileNames, PathContext, write_path};
use crate::planner::answer::{NoSolution, NoSolutionReason, Solution};
use crate::planner::recording::{Recording, RecordingError};
use crate::planner::report::Report;
use crate::planner::solving::{Planner, panic_message};
use foliate_components::graph::ConstraintGraph;
use foliate_schedulers::Scheduler;
use foliate_systems::events::CancelToken;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// One problem with one seed.
pub(crate) struct Solve<'a> {
    pub entry: &'a Entry,
    pub seed: u64,
    pub settings: &'a Settings,
    pub scheduler: &'a Arc<dyn Scheduler>,
    pub token: &'a CancelToken,
    pub memory_limit: Option<MemoryLimit>,
    /// The batch's folder.
    pub out: &'a Path,
    /// Where it is recorded if it finds no path.
    pub failures: Option<&'a FailureFolder>,
}

impl Solve<'_> {
    /// Solves, whatever happens. The path is written.
    pub(crate) fn row(&self) -> Row {
        let started = Instant::now();
        let mut row = Row::new(self.entry, self.seed, self.scheduler.name());
        // Nothing that a panic may leave half done is used again: a search owns its world, and what solves share is
        // immutable or filled in whole.
        match catch_unwind(AssertUnwindSafe(|| self.fill(&mut row))) {
            Ok(Ok(())) => {}
            Ok(Err(message)) => row.fail(RowOutcome::Failed, message),
            Err(panic) => {
                row = Row::new(self.entry, self.seed, self.scheduler.name());
                row.solve_time = started.elapsed();
                row.fail(RowOutcome::Crashed, panic_message(panic.as_ref()));
            }
        }
        row
    }

    fn fill(&self, row: &mut Row) -> Result<(), String> {
        let planner = self.planner()?;
        let Some(measurement) = &self.settings.improvement else {
            let answer = planner.solve_on(1);
            row.fill(&answer);
            self.record_failure(row, &answer);
            return answer.map_or(Ok(()), |solution| self.write_path(&solution));
        };
        let watch = Watch::new(measurement.times());
        let planner = watch.on(measurement.apply(planner));
        let answer = planner.solve_on(1);
        row.fill(&answer);
        self.record_failure(row, &answer);
        let Ok(solution) = &answer else { return Ok(()) };
        let was_stopped = solution.report.improvement.as_ref().is_some_and(|improvement| improvement.stopped);
        if was_stopped && self.token.is_cancelled() {
            // It had less than its budget.
            row.fail(RowOutcome::Cancelled, String::new());
            return Ok(());
        }
        row.answer = Some(watch.numbers(&planner, solution));
        self.write_path(solution)
    }

    /// A planner that ends with the first path.
    fn planner(&self) -> Result<Planner, String> {
        let mut search = self.settings.search.clone();
        let share = self.memory_limit.map_or(u64::MAX, |limit| limit.counted(self.settings.threads));
        search.max_bytes = search.max_bytes.min(share);
        // Nothing but what follows from files is shared by solves: their times are those of the first.
        let planner = Planner::from_tables(Arc::clone(self.entry.model().tables()))
            .map_err(|error| error.to_string())?
            .settings(search)
            .seed(self.seed)
            .first_path()
            .scheduler(Arc::clone(self.scheduler))
            .cancelled_by(self.token.clone())
            .time_limit(self.settings.time_limit.saturating_sub(self.entry.load_time()));
        let planner = if self.failures.is_some() { planner.record() } else { planner };
        Ok(match self.memory_limit {
            Some(limit) => planner.memory_limit(limit),
            None => planner,
        })
    }

    /// Records a solve that found no path, where that is asked for; a recording that cannot be written is told in the row.
    fn record_failure(&self, row: &mut Row, answer: &Result<Solution, NoSolution>) {
        let (Some(failures), Some(scene), Err(none)) = (self.failures, self.entry.scene(), answer) else { return };
        if matches!(none.reason, NoSolutionReason::Cancelled | NoSolutionReason::Threads { .. }) {
            return;
        }
        let Some(file) = failures.next(&self.entry.file_stem(), self.seed) else { return };
        let written = save::model_names(scene, &file)
            .map_err(RecordingError::from)
            .and_then(|models| Recording::of(&self.context(&models, &none.model.graph), answer).save(&file));
        if let Err(error) = written {
            let told = if row.message.is_empty() { String::new() } else { format!("{}; ", row.message) };
            row.message = format!("{told}recording not written: {error}");
        }
    }

    /// What files say besides a path.
    fn context<'b>(&'b self, models: &'b FileNames, graph: &'b ConstraintGraph) -> PathContext<'b> {
        PathContext {
            problem: &self.entry.model().problem,
            graph,
            models,
            seed: self.seed,
            scheduler: self.scheduler.name(),
            simd: self.settings.search.level.name(),
        }
    }

    fn write_path(&self, solution: &Solution) -> Result<(), String> {
        self.try_to_write(solution).map_err(|error| format!("path not written: {error}"))
    }

    /// Writes `paths/SCENE-SEED.json`, where the models have names.
    fn try_to_write(&self, solution: &Solution) -> Result<(), PathFileError> {
        let Some(scene) = self.entry.scene() else { return Ok(()) };
        let file = record::path_file(self.out, &self.entry.file_stem(), self.seed);
        let models = save::model_names(scene, &file)?;
        save::save(&write_path(&self.context(&models, &solution.model.graph), &solution.path), &file)
    }
}

impl Row {
    /// Takes over what a solve has found.
    fn fill(&mut self, answer: &Result<Solution, NoSolution>) {
        let report = Report::of(answer);
        self.solve_time = report.time();
        self.work = Some(Work {
            steps: report.steps,
            candidates: report.candidates,
            nodes: report.nodes,
            edges: report.edges,
            fingerprint: report.fingerprint,
        });
        match answer {
            Ok(solution) => {
                self.outcome = RowOutcome::Solved;
                self.path = Some(PathNumbers {
                    segments: solution.path.segments.len(),
                    length: report.path_length.unwrap_or_default(),
                    min_clearance: solution.certificate().min_clearance,
                    max_residual: solution.certificate().max_residual,
                });
            }
            Err(none) => {
                self.fail(RowOutcome::of_reason(&none.reason), none.reason.detail().unwrap_or_default());
                if matches!(none.reason, NoSolutionReason::Threads { .. }) {
                    self.work = None;
                }
            }
        }
    }

    fn fail(&mut self, outcome: RowOutcome, message: String) {
        (self.outcome, self.message) = (outcome, message);
    }
}
