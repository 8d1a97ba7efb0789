//! The run of a batch: the threads that solve and record.

use crate::batch::entry::Entry;
use crate::batch::error::{BatchError, MOST_SOLVES};
use crate::batch::improvement::plots;
use crate::batch::improvement::plots::Plot;
use crate::batch::improvement::summary::{BestDurations, ImprovementTable};
use crate::batch::kept::Identity;
use crate::batch::machine::{Machine, today};
use crate::batch::record::{FailureFolder, MOST_FAILURES, Recorder};
use crate::batch::row::{Row, RowOutcome};
use crate::batch::settings::Settings;
use crate::batch::solve::Solve;
use crate::batch::table::{SceneSummary, Table};
use crate::batch::{error, kept, record};
use crate::os::memory::MemoryLimit;
use foliate_components::problem::cost::MotionCost;
use foliate_schedulers::Scheduler;
use foliate_systems::events::CancelToken;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Problems and seeds to solve.
pub struct Batch {
    entries: Vec<Entry>,
    settings: Settings,
    scheduler: Arc<dyn Scheduler>,
    token: CancelToken,
    memory_limit: Option<MemoryLimit>,
    best: BestDurations,
    failures: Option<FailureFolder>,
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
        Ok(Self {
            entries,
            settings,
            scheduler,
            token: CancelToken::default(),
            memory_limit: None,
            best: BestDurations::default(),
            failures: None,
        })
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

    /// Compares the improved paths with the shortest durations of other runs too: see [`BestDurations::read`].
    #[must_use]
    pub fn best(mut self, best: BestDurations) -> Self {
        self.best = best;
        self
    }

    /// Records solves that find no path, as `SCENE-SEED.search` in a folder, which is made where it is missing: the first hundred to
    /// end, each of at most 16 MiB. Solves are measured while they keep what a recording needs.
    #[must_use]
    pub fn record_failures(mut self, folder: PathBuf) -> Self {
        self.failures = Some(FailureFolder::new(folder));
        self
    }

    /// How many failed solves this batch has recorded, and how many there were; none where it was not asked to record.
    #[must_use]
    pub fn failures_recorded(&self) -> Option<(usize, usize)> {
        let failed = self.failures.as_ref()?.failed();
        Some((failed.min(MOST_FAILURES), failed))
    }

    /// Number of solves.
    #[must_use]
    pub fn solves(&self) -> usize {
        self.entries.len() * self.settings.seeds.count() as usize
    }

    /// Solves everything. Writes `results.csv`, `paths/SCENE-SEED.json`, `settings.json` and `table.md` into the folder `out`,
    /// which is made where it is missing; where paths are improved also `improvement.csv`, `history.csv` and `plots/SCENE.svg`.
    ///
    /// While the batch runs, rows stand in `results.csv` in the order in which solves end, each written as soon as it is
    /// known; in the end they are put in the order of scenes and seeds. `on_row` hears of each. Rows come back in order; of a
    /// batch that was cancelled there are those of the solves that had ended.
    ///
    /// # Errors
    /// `out` holds results already or cannot be written.
    pub fn run(&self, out: &Path, on_row: impl Fn(&Row) + Sync) -> Result<Vec<Row>, BatchError> {
        self.go_on(Recorder::create(out, &self.identity(), self.settings.improvement.is_some())?, out, on_row)
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
        let improves = self.settings.improvement.is_some();
        self.go_on(Recorder::resume(out, &self.identity(), improves, index, has_path)?, out, on_row)
    }

    fn go_on(&self, recorder: Recorder, out: &Path, on_row: impl Fn(&Row) + Sync) -> Result<Vec<Row>, BatchError> {
        self.failures.as_ref().map_or(Ok(()), FailureFolder::create)?;
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
        if self.settings.improvement.is_some() {
            plots::write(out, &self.plots(), &rows)?;
        }
        Ok(rows)
    }

    /// The plots of the scenes.
    fn plots(&self) -> Vec<Plot> {
        let plot = |entry: &Entry| Plot {
            scene: entry.name().into(),
            file: entry.file_stem() + ".svg",
            unit: match entry.model().problem.cost.motion {
                MotionCost::Length => "m",
                _ => "s",
            },
        };
        self.entries.iter().map(plot).collect()
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
            ("improvement", settings.improvement.as_ref().map_or_else(|| "none".into(), ToString::to_string)),
            ("search", format!("{:?}", settings.search.clone().with(|s| s.seed = 0))),
        ];
        Identity(scenes.chain(common.map(|(name, value)| (name.to_owned(), value))).collect())
    }

    /// The table of some rows of this batch.
    #[must_use]
    pub fn table(&self, rows: &[Row]) -> Table {
        let names: Vec<&str> = self.entries.iter().map(Entry::name).collect();
        let measurement = self.settings.improvement.as_ref();
        Table {
            machine: Machine::here(),
            date: today(),
            scheduler: self.scheduler.name().into(),
            search: self.settings.search.clone(),
            seeds: self.settings.seeds,
            threads: self.settings.threads,
            time_limit: self.settings.time_limit,
            scenes: self.entries.iter().map(|entry| SceneSummary::of(entry.name(), rows)).collect(),
            improvement: measurement.map(|how| ImprovementTable::of(how, &names, rows, &self.best)),
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
            let row = Solve {
                entry: &self.entries[index / seeds],
                seed,
                settings: &self.settings,
                scheduler: &self.scheduler,
                token: &self.token,
                memory_limit: self.memory_limit,
                out,
                failures: self.failures.as_ref(),
            }
            .row();
            if row.outcome == RowOutcome::Cancelled {
                return Ok(());
            }
            recorder.lock().unwrap_or_else(PoisonError::into_inner).record(index, &row)?;
            on_row(&row);
        }
    }
}
