//! The run of a batch: its settings, and the threads that solve and record.

use crate::batch::entry::Entry;
use crate::batch::error::{BatchError, MOST_SOLVES};
use crate::batch::kept::Identity;
use crate::batch::machine::{Machine, today};
use crate::batch::record::Recorder;
use crate::batch::row::{PathNumbers, Row, RowOutcome, Work};
use crate::batch::seeds::Seeds;
use crate::batch::table::{SceneSummary, Table};
use crate::batch::{error, kept, record};
use crate::memory::MemoryLimit;
use crate::path_file::save;
use crate::path_file::write::{PathContext, write_path};
use crate::planner::answer::{NoSolution, NoSolutionReason, Solution};
use crate::planner::report::Report;
use crate::planner::solving::{Planner, panic_message};
use foliate_schedulers::Scheduler;
use foliate_systems::events::CancelToken;
use foliate_systems::settings::SearchSettings;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What all solves of a batch share.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The seeds, both ends included.
    pub seeds: Seeds,
    /// Solves side by side; each of them uses one thread.
    pub threads: usize,
    /// Wall time after which one solve gives up. The time that its problem took to load, once for all its solves, counts for each.
    pub time_limit: Duration,
    /// Settings of every search; the seed in them is not used.
    pub search: SearchSettings,
}

/// Problems and seeds to solve.
pub struct Batch {
    entries: Vec<Entry>,
    settings: Settings,
    scheduler: Arc<dyn Scheduler>,
    token: CancelToken,
    memory_limit: Option<MemoryLimit>,
}

impl Batch {
    /// A batch with the default scheduler.
    ///
    /// # Errors
    /// No scenes, two of one name, or more than a million solves.
    pub fn new(entries: Vec<Entry>, settings: Settings) -> Result<Self, BatchError> {
        if entries.is_empty() {
            return Err(BatchError::Empty);
        }
        let mut names: Vec<String> = entries.iter().map(Entry::file_stem).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(BatchError::SameName(pair[0].clone()));
        }
        let solves = settings.seeds.count().saturating_mul(entries.len() as u64);
        if solves > MOST_SOLVES {
            return Err(BatchError::TooMany(solves));
        }
        let scheduler = foliate_schedulers::default_scheduler().into();
        Ok(Self { entries, settings, scheduler, token: CancelToken::default(), memory_limit: None })
    }

    /// Uses another scheduler.
    #[must_use]
    pub fn scheduler(mut self, scheduler: Arc<dyn Scheduler>) -> Self {
        self.scheduler = scheduler;
        self
    }

    /// Lets a token end the batch: solves under way stop and have no row, no further ones begin.
    #[must_use]
    pub fn cancelled_by(mut self, token: CancelToken) -> Self {
        self.token = token;
        self
    }

    /// Bounds the memory of all solves together. Each may count its share; where the process has more than the limit all that
    /// run at that time end.
    #[must_use]
    pub fn memory_limit(mut self, limit: MemoryLimit) -> Self {
        self.memory_limit = Some(limit);
        self
    }

    /// Number of solves.
    #[must_use]
    pub fn solves(&self) -> usize {
        self.entries.len() * self.settings.seeds.count() as usize
    }

    /// Solves everything. Writes `results.csv`, `paths/SCENE-SEED.json`, `settings.json` and `table.md` into the folder `out`,
    /// which is made where it is missing.
    ///
    /// While the batch runs, rows stand in `results.csv` in the order in which solves end, each written as soon as it is
    /// known; in the end they are put in the order of scenes and seeds. `on_row` hears of each. Rows come back in order; of a
    /// batch that was cancelled there are those of the solves that had ended.
    ///
    /// # Errors
    /// `out` holds results already or cannot be written.
    pub fn run(&self, out: &Path, on_row: impl Fn(&Row) + Sync) -> Result<Vec<Row>, BatchError> {
        self.go_on(Recorder::create(out, &self.identity())?, out, on_row)
    }

    /// As [`Self::run`], in a folder in which the same batch was begun: rows that are there are kept, the others are added. A
    /// row that was not written whole, that could not start, or whose path is missing is solved again. The folder may be new.
    ///
    /// # Errors
    /// The results in `out` were made with other settings, problems or by another version, are no results, or another process
    /// is writing them; or as for [`Self::run`].
    pub fn resume(&self, out: &Path, on_row: impl Fn(&Row) + Sync) -> Result<Vec<Row>, BatchError> {
        let seeds = self.settings.seeds;
        let index = |row: &Row| {
            let entry = self.entries.iter().position(|entry| entry.name() == row.scene)?;
            let seed = row.seed.checked_sub(seeds.first()).filter(|&seed| seed < seeds.count())?;
            (row.scheduler == self.scheduler.name()).then_some(entry * seeds.count() as usize + seed as usize)
        };
        let has_path = |row: &Row| {
            let entry = self.entries.iter().find(|entry| entry.name() == row.scene && entry.scene().is_some());
            row.path.is_none() || entry.is_none_or(|e| record::path_file(out, &e.file_stem(), row.seed).is_file())
        };
        self.go_on(Recorder::resume(out, &self.identity(), index, has_path)?, out, on_row)
    }

    fn go_on(&self, recorder: Recorder, out: &Path, on_row: impl Fn(&Row) + Sync) -> Result<Vec<Row>, BatchError> {
        let done = recorder.done();
        let waiting: Vec<usize> = (0..self.solves()).filter(|index| !done.contains(index)).collect();
        let (recorder, next, failure) = (Mutex::new(recorder), AtomicUsize::new(0), Mutex::new(None));
        std::thread::scope(|scope| {
            for _ in 0..self.settings.threads.clamp(1, waiting.len().max(1)) {
                scope.spawn(|| {
                    if let Err(error) = self.work(&waiting, &next, &recorder, &on_row, out) {
                        next.store(waiting.len(), Ordering::Relaxed);
                        *failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                    }
                });
            }
        });
        if let Some(error) = failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        let rows = recorder.into_inner().unwrap_or_else(PoisonError::into_inner).finish()?;
        error::write_whole(&out.join("table.md"), &self.table(&rows).markdown())?;
        Ok(rows)
    }

    /// What decides the rows.
    fn identity(&self) -> Identity {
        let settings = &self.settings;
        let scenes = self.entries.iter().map(|entry| (format!("scene {}", entry.name()), kept::fingerprint(entry)));
        let common = [
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("scheduler", self.scheduler.name().to_owned()),
            ("seeds", settings.seeds.to_string()),
            ("time_limit_s", format!("{:?}", settings.time_limit.as_secs_f64())),
            ("search", format!("{:?}", settings.search.clone().with(|s| s.seed = 0))),
        ];
        Identity(scenes.chain(common.map(|(name, value)| (name.to_owned(), value))).collect())
    }

    /// The table of some rows of this batch.
    #[must_use]
    pub fn table(&self, rows: &[Row]) -> Table {
        Table {
            machine: Machine::here(),
            date: today(),
            scheduler: self.scheduler.name().into(),
            search: self.settings.search.clone(),
            seeds: self.settings.seeds,
            threads: self.settings.threads,
            time_limit: self.settings.time_limit,
            scenes: self.entries.iter().map(|entry| SceneSummary::of(entry.name(), rows)).collect(),
        }
    }

    /// Takes one solve after the other until none is left.
    fn work(
        &self,
        waiting: &[usize],
        next: &AtomicUsize,
        recorder: &Mutex<Recorder>,
        on_row: &(impl Fn(&Row) + Sync),
        out: &Path,
    ) -> Result<(), BatchError> {
        let seeds = self.settings.seeds.count() as usize;
        loop {
            let index = waiting.get(next.fetch_add(1, Ordering::Relaxed)).copied();
            let Some(index) = index.filter(|_| !self.token.is_cancelled()) else { return Ok(()) };
            let seed = self.settings.seeds.first() + (index % seeds) as u64;
            let row = self.solve(&self.entries[index / seeds], seed, out);
            if row.outcome == RowOutcome::Cancelled {
                return Ok(());
            }
            recorder.lock().unwrap_or_else(PoisonError::into_inner).record(index, &row)?;
            on_row(&row);
        }
    }

    /// One solve, to its row.
    fn solve(&self, entry: &Entry, seed: u64, out: &Path) -> Row {
        let started = Instant::now();
        let mut row = Row::new(entry, seed, self.scheduler.name());
        // Nothing that a panic may leave half done is used again: a search owns its world, and what solves share is
        // immutable or filled in whole.
        let solved = catch_unwind(AssertUnwindSafe(|| {
            let mut search = self.settings.search.clone();
            let share = self.memory_limit.map_or(u64::MAX, |limit| limit.counted(self.settings.threads));
            search.max_bytes = search.max_bytes.min(share);
            // Nothing but what follows from files is shared by solves: their times are those of the first.
            let planner = Planner::from_tables(Arc::clone(entry.model().tables()))
                .map_err(|error| error.to_string())?
                .settings(search)
                .seed(seed)
                .first_path()
                .scheduler(Arc::clone(&self.scheduler))
                .cancelled_by(self.token.clone())
                .time_limit(self.settings.time_limit.saturating_sub(entry.load_time()));
            let planner = match self.memory_limit {
                Some(limit) => planner.memory_limit(limit),
                None => planner,
            };
            let answer = planner.solve_on(1);
            row.fill(&answer);
            let Ok(solution) = &answer else { return Ok(()) };
            self.write_path(entry, seed, solution, out).map_err(|error| format!("path not written: {error}"))
        }));
        match solved {
            Ok(Ok(())) => {}
            Ok(Err(message)) => row.fail(RowOutcome::Failed, message),
            Err(panic) => {
                row = Row::new(entry, seed, self.scheduler.name());
                row.solve_time = started.elapsed();
                row.fail(RowOutcome::Crashed, panic_message(panic.as_ref()));
            }
        }
        row
    }

    /// Writes `paths/SCENE-SEED.json`, where there is a path and its models have names.
    fn write_path(
        &self,
        entry: &Entry,
        seed: u64,
        solution: &Solution,
        out: &Path,
    ) -> Result<(), crate::path_file::error::PathFileError> {
        let Some(scene) = entry.scene() else { return Ok(()) };
        let file = record::path_file(out, &entry.file_stem(), seed);
        let models = save::model_names(scene, &file)?;
        let context = PathContext {
            problem: &entry.model().problem,
            graph: &solution.model.graph,
            models: &models,
            seed,
            scheduler: self.scheduler.name(),
            simd: self.settings.search.level.name(),
        };
        save::save(&write_path(&context, &solution.path), &file)
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
