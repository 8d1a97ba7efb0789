//! The threads of a batch that solve and record.

use crate::batch::entry::Entry;
use crate::batch::error::{BatchError, write_whole};
use crate::batch::improvement::plots;
use crate::batch::improvement::plots::Plot;
use crate::batch::results::record;
use crate::batch::results::record::{FailureFolder, Recorder};
use crate::batch::results::row::{Label, Row, RowOutcome};
use crate::batch::run::batch::{Batch, Progress};
use crate::batch::run::cases::{Case, Cases};
use crate::batch::run::cores::Cores;
use crate::batch::run::queue::Queue;
use crate::batch::run::solve::Solve;
use foliate_components::problem::cost::MotionCost;
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// What the threads of a run share.
struct Run<'a, F> {
    out: &'a Path,
    cases: Cases,
    ids: &'a [String],
    /// Rows in all.
    all: usize,
    queue: Mutex<Queue>,
    recorder: Mutex<Recorder>,
    failure: Mutex<Option<BatchError>>,
    cores: Cores,
    on_row: F,
}

impl Batch {
    /// Solves everything. Writes `results.csv`, a file for each path into `paths/`, `settings.json` and `table.md` into the folder `out`,
    /// which is made where it is missing; where paths are improved also `improvement.csv`, `history.csv` and `plots/SCENE.svg`.
    ///
    /// While the batch runs, rows stand in `results.csv` in the order in which solves end, each written as soon as it is
    /// known; in the end they are put in the order of scenes, schedulers, settings, instances and seeds. `on_row` hears of each. Rows come
    /// back in order; of a batch that was cancelled there are those of the solves that had ended. What is expected to take longest is
    /// solved first.
    ///
    /// # Errors
    /// `out` holds results already or cannot be written.
    pub fn run(&self, out: &Path, on_row: impl Fn(&Row) + Sync) -> Result<Vec<Row>, BatchError> {
        let ids = self.ids();
        let recorder = Recorder::create(out, &self.identity(), self.settings.improvement.is_some())?;
        self.go_on(&ids, recorder, out, on_row)
    }

    /// As [`Self::run`], in a folder in which the same batch was begun: rows that are there are kept, the others are added. A
    /// row that was not written whole, that could not start, or whose path is missing is solved again. The folder may be new.
    ///
    /// # Errors
    /// The results in `out` were made with other settings, problems or by another version, are no results, or another process
    /// is writing them; or as for [`Self::run`].
    pub fn resume(&self, out: &Path, on_row: impl Fn(&Row) + Sync) -> Result<Vec<Row>, BatchError> {
        let (ids, cases) = (self.ids(), self.cases());
        let numbers: HashMap<&str, usize> = self.numbers(&ids).into_iter().map(|n| (ids[n].as_str(), n)).collect();
        let index = |row: &Row| numbers.get(row.id.as_str()).copied();
        let has_path = |row: &Row| {
            let Some(number) = index(row).filter(|_| row.path.is_some() && self.keeps_paths) else { return true };
            let case = cases.case(number);
            self.entries[case.entry].scene().is_none() || record::path_file(out, &self.stem(case)).is_file()
        };
        let improves = self.settings.improvement.is_some();
        self.go_on(&ids, Recorder::resume(out, &self.identity(), improves, index, has_path)?, out, on_row)
    }

    fn go_on(
        &self,
        ids: &[String],
        recorder: Recorder,
        out: &Path,
        on_row: impl Fn(&Row) + Sync,
    ) -> Result<Vec<Row>, BatchError> {
        self.failures.as_ref().map_or(Ok(()), FailureFolder::create)?;
        let (cases, numbers) = (self.cases(), self.numbers(ids));
        let run = Run {
            out,
            cases,
            ids,
            all: numbers.len(),
            queue: Mutex::new(self.queue(&cases, &numbers, &recorder)),
            recorder: Mutex::new(recorder),
            failure: Mutex::new(None),
            cores: Cores::new(self.settings.threads),
            on_row,
        };
        self.tell(&run);
        std::thread::scope(|scope| {
            for _ in 0..self.settings.threads.clamp(1, run.all.max(1)) {
                scope.spawn(|| {
                    if let Err(error) = self.work(&run) {
                        *locked(&run.failure) = Some(error);
                    }
                });
            }
        });
        if let Some(error) = run.failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        let rows = run.recorder.into_inner().unwrap_or_else(PoisonError::into_inner).finish()?;
        write_whole(&out.join("table.md"), &self.table(&rows).markdown())?;
        if self.settings.improvement.is_some() {
            plots::write(out, &self.plots(), &rows)?;
        }
        Ok(rows)
    }

    /// The solves that have no row yet, with what the rows that are there tell of their times.
    fn queue(&self, cases: &Cases, numbers: &[usize], recorder: &Recorder) -> Queue {
        let size = |group: u64| {
            let entry = group as usize / (self.schedulers.len() * self.variants.len());
            self.entries[entry].model().problem.robot.space.size()
        };
        let mut queue = Queue::new((0..cases.groups()).map(size));
        let mut is_done = vec![false; cases.count() as usize];
        for (number, row) in recorder.done() {
            is_done[*number] = true;
            queue.know(cases.group(*number), total_time(row));
        }
        let waiting = numbers.iter().filter(|&&number| !is_done[number]);
        waiting.for_each(|&number| queue.push(cases.group(number), number));
        queue
    }

    /// Takes one solve after the other until none is left.
    fn work<F: Fn(&Row) + Sync>(&self, run: &Run<'_, F>) -> Result<(), BatchError> {
        while !self.token.is_cancelled() && locked(&run.failure).is_none() {
            let Some((group, number, began)) = locked(&run.queue).take() else { return Ok(()) };
            let case = run.cases.case(number);
            let variant = &self.variants[case.variant];
            let cores = run.cores.take(variant.threads);
            let row = self.solve(case, &run.ids[number], run.out).row();
            drop(cores);
            if row.outcome == RowOutcome::Cancelled {
                return Ok(());
            }
            locked(&run.queue).ended(group, began, total_time(&row));
            locked(&run.recorder).record(number, &row)?;
            (run.on_row)(&row);
            self.tell(run);
        }
        Ok(())
    }

    fn solve<'a>(&'a self, case: Case, id: &str, out: &'a Path) -> Solve<'a> {
        let (variant, scheduler) = (&self.variants[case.variant], &self.schedulers[case.scheduler]);
        let entry = &self.entries[case.entry];
        Solve {
            label: Label {
                scene: entry.name().to_owned(),
                seed: case.seed,
                scheduler: scheduler.name().to_owned(),
                instance: case.instance,
                settings: variant.name.clone(),
                threads: variant.threads,
                id: id.to_owned(),
            },
            stem: self.stem(case),
            entry,
            variations: self.variations.get(case.entry),
            settings: &self.settings,
            variant,
            scheduler,
            token: &self.token,
            memory_limit: self.memory_limit,
            out,
            keeps_path: self.keeps_paths,
            failures: self.failures.as_ref(),
        }
    }

    fn tell<F>(&self, run: &Run<'_, F>) {
        let Some(progress) = &self.progress else { return };
        let done = locked(&run.recorder).done().len();
        let left = locked(&run.queue).left().map(|left| left / self.settings.threads.max(1) as u32);
        progress(Progress { done, all: run.all, left });
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
}

fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How long a row took, improvement included.
fn total_time(row: &Row) -> Duration {
    let improvement = row.answer.as_ref().and_then(|answer| Some(answer.improvement.as_ref()?.time));
    row.solve_time + improvement.unwrap_or_default() + row.answer.as_ref().map_or(Duration::ZERO, |a| a.timing_time)
}
