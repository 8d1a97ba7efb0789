//! One solve of a batch, to its row and its path.

use crate::batch::entry::Entry;
use crate::batch::improvement::watch::Watch;
use crate::batch::results::record;
use crate::batch::results::record::FailureFolder;
use crate::batch::results::row::{Label, PathNumbers, Row, RowOutcome, Work};
use crate::batch::run::settings::Settings;
use crate::batch::run::variant::Variant;
use crate::batch::vary::variations::Variations;
use crate::os::memory::MemoryLimit;
use crate::path_file::error::PathFileError;
use crate::path_file::save;
use crate::path_file::write::{FileNames, PathContext};
use crate::planner::answer::{NoSolution, NoSolutionReason, Solution};
use crate::planner::recording::{Recording, RecordingError};
use crate::planner::report::Report;
use crate::planner::solving::{Planner, panic_message};
use crate::scene::assemble::scene::Scene;
use foliate_schedulers::Scheduler;
use foliate_systems::events::CancelToken;
use foliate_systems::planning_model::ProblemTables;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// One problem with one seed.
pub(crate) struct Solve<'a> {
    pub label: Label,
    /// Name of its files, without ending.
    pub stem: String,
    pub entry: &'a Entry,
    /// How the problem varies, where it does.
    pub variations: Option<&'a Variations>,
    pub settings: &'a Settings,
    pub variant: &'a Variant,
    pub scheduler: &'a Arc<dyn Scheduler>,
    pub token: &'a CancelToken,
    pub memory_limit: Option<MemoryLimit>,
    /// The batch's folder.
    pub out: &'a Path,
    /// Whether its path is written.
    pub keeps_path: bool,
    /// Where it is recorded if it finds no path.
    pub failures: Option<&'a FailureFolder>,
}

/// The problem that is solved: that of the entry, or an instance of it.
struct Posed {
    tables: Arc<ProblemTables>,
    scene: Option<Scene>,
    load_time: Duration,
}

impl Solve<'_> {
    /// Solves, whatever happens. The path is written.
    pub(crate) fn row(&self) -> Row {
        let started = Instant::now();
        let mut row = Row::new(self.label.clone());
        // Nothing that a panic may leave half done is used again: a search owns its world, and what solves share is
        // immutable or filled in whole.
        match catch_unwind(AssertUnwindSafe(|| self.fill(&mut row))) {
            Ok(Ok(())) => {}
            Ok(Err(message)) => row.fail(RowOutcome::Failed, message),
            Err(panic) => {
                row = Row::new(self.label.clone());
                row.solve_time = started.elapsed();
                row.load_time = self.entry.load_time();
                row.fail(RowOutcome::Crashed, panic_message(panic.as_ref()));
            }
        }
        row
    }

    fn fill(&self, row: &mut Row) -> Result<(), String> {
        let Some(posed) = self.pose(row) else { return Ok(()) };
        row.load_time = posed.load_time;
        let planner = self.planner(&posed)?;
        let Some(measurement) = &self.settings.improvement else {
            let answer = planner.solve_on(self.variant.threads);
            row.fill(&answer);
            self.record_failure(row, &posed, &answer);
            return answer.map_or(Ok(()), |solution| self.write_path(&posed, &solution));
        };
        let watch = Watch::new(measurement.times());
        let planner = watch.on(measurement.apply(planner));
        let answer = planner.solve_on(self.variant.threads);
        row.fill(&answer);
        self.record_failure(row, &posed, &answer);
        let Ok(solution) = &answer else { return Ok(()) };
        let was_stopped = solution.report.improvement.as_ref().is_some_and(|improvement| improvement.stopped);
        if was_stopped && self.token.is_cancelled() {
            // It had less than its budget.
            row.fail(RowOutcome::Cancelled, String::new());
            return Ok(());
        }
        row.answer = Some(watch.numbers(&planner, solution));
        self.write_path(&posed, solution)
    }

    /// The problem; `None` where no draw made the instance, which the row then says.
    fn pose(&self, row: &mut Row) -> Option<Posed> {
        let (Some(variations), Some(number)) = (self.variations, self.label.instance) else {
            let (tables, scene) = (Arc::clone(self.entry.model().tables()), self.entry.scene().cloned());
            return Some(Posed { tables, scene, load_time: self.entry.load_time() });
        };
        let started = Instant::now();
        match variations.instance(number) {
            Ok(instance) => {
                row.refused = instance.refused;
                Some(Posed { tables: instance.tables, scene: instance.scene, load_time: started.elapsed() })
            }
            Err(none) => {
                row.load_time = started.elapsed();
                row.fail(RowOutcome::NoInstance, none.to_string());
                row.refused = none.refused;
                None
            }
        }
    }

    /// A planner that ends with the first path.
    fn planner(&self, posed: &Posed) -> Result<Planner, String> {
        let mut search = self.variant.search.clone();
        let side_by_side = (self.settings.threads / self.variant.threads.max(1)).max(1);
        let share = self.memory_limit.map_or(u64::MAX, |limit| limit.counted(side_by_side));
        search.max_bytes = search.max_bytes.min(share);
        // Nothing but what follows from files is shared by solves: their times are those of the first.
        let planner = Planner::from_tables(Arc::clone(&posed.tables))
            .map_err(|error| error.to_string())?
            .settings(search)
            .seed(self.label.seed)
            .first_path()
            .scheduler(Arc::clone(self.scheduler))
            .cancelled_by(self.token.clone())
            .time_limit(self.settings.time_limit.saturating_sub(posed.load_time));
        let planner = if self.failures.is_some() { planner.record() } else { planner };
        Ok(match self.memory_limit {
            Some(limit) => planner.memory_limit(limit),
            None => planner,
        })
    }

    /// Records a solve that found no path, where that is asked for; a recording that cannot be written is told in the row.
    fn record_failure(&self, row: &mut Row, posed: &Posed, answer: &Result<Solution, NoSolution>) {
        let (Some(failures), Some(scene), Err(none)) = (self.failures, &posed.scene, answer) else { return };
        if matches!(none.reason, NoSolutionReason::Cancelled | NoSolutionReason::Threads { .. }) {
            return;
        }
        let Some(file) = failures.next(&self.stem) else { return };
        let written = save::model_names(scene, &file)
            .map_err(RecordingError::from)
            .and_then(|models| Recording::of(&self.context(posed, &models, none), answer).save(&file));
        if let Err(error) = written {
            let told = if row.message.is_empty() { String::new() } else { format!("{}; ", row.message) };
            row.message = format!("{told}recording not written: {error}");
        }
    }

    /// What a recording says besides the search.
    fn context<'b>(&'b self, posed: &'b Posed, models: &'b FileNames, none: &'b NoSolution) -> PathContext<'b> {
        PathContext {
            problem: &posed.tables.problem,
            graph: &none.model.graph,
            models,
            seed: self.label.seed,
            scheduler: self.scheduler.name(),
            simd: self.variant.search.level.name(),
        }
    }

    fn write_path(&self, posed: &Posed, solution: &Solution) -> Result<(), String> {
        if !self.keeps_path {
            return Ok(());
        }
        self.try_to_write(posed, solution).map_err(|error| format!("path not written: {error}"))
    }

    /// Writes `paths/STEM.json`, where the models have names.
    fn try_to_write(&self, posed: &Posed, solution: &Solution) -> Result<(), PathFileError> {
        let Some(scene) = &posed.scene else { return Ok(()) };
        let search = (self.label.seed, self.scheduler.name(), self.variant.search.level);
        solution.save(scene, search, &record::path_file(self.out, &self.stem))
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
