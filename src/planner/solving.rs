//! Plans for one problem: what a host sets, and the solves.

use crate::os::memory::MemoryLimit;
use crate::planner::answer::{NoSolution, NoSolutionReason, Solution};
use crate::planner::object_tries::{Doubts, ObjectTries, ToldOfObjects};
use crate::planner::refinement::{BetterPath, Refinement};
use crate::planner::report::Report;
use crate::planner::search_record::{DEFAULT_RECORDING_BYTES, SearchRecord};
use foliate_components::graph::ConstraintGraph;
use foliate_components::outcome::SearchOutcome;
use foliate_components::path::ManipulationPath;
use foliate_components::problem::Problem;
use foliate_schedulers::Scheduler;
use foliate_systems::events::{CancelToken, EventSink, SolveEvent, SolveId, StopSignal};
use foliate_systems::improvement::{ImprovementSettings, PathCost};
use foliate_systems::planning_model::{Model, ModelError, PlanningModel, ProblemTables};
use foliate_systems::search::Search;
use foliate_systems::settings::SearchSettings;
use foliate_systems::trajectory::{TimedPathError, timed_path};
use std::any::Any;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Events that a host may leave unread before they are dropped (and counted).
const EVENT_CAPACITY: usize = 4096;

/// Plans for one problem; any number of solves may share it, on any threads.
pub struct Planner {
    model: PlanningModel,
    settings: SearchSettings,
    scheduler: Arc<dyn Scheduler>,
    time_limit: Option<Duration>,
    memory_limit: Option<MemoryLimit>,
    token: CancelToken,
    events: EventSink,
    graph_time: Duration,
    refinement: Refinement,
    /// Told of objects that likely cannot be moved as goals want it.
    likely_impossible: Option<Arc<ToldOfObjects>>,
    /// How large a recording of a search may be, where its searches are to be recorded, bytes.
    recording: Option<u64>,
    /// Solves that have begun.
    solves: AtomicU64,
}

impl fmt::Debug for Planner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Planner")
            .field("problem", &self.model.problem.name)
            .field("scheduler", &self.scheduler.name())
            .field("settings", &self.settings)
            .field("time_limit", &self.time_limit)
            .field("memory_limit", &self.memory_limit)
            .finish_non_exhaustive()
    }
}

impl Planner {
    /// Prepares to plan for a problem, or for that of a scene: builds the constraint graph and the tables.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn new(problem: impl Into<Problem>) -> Result<Self, ModelError> {
        Self::from_tables(Arc::new(ProblemTables::new(problem.into())))
    }

    /// As [`Self::new`], where the tables of the problem are there already: builds the constraint graph.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn from_tables(tables: Arc<ProblemTables>) -> Result<Self, ModelError> {
        let started = Instant::now();
        let planner = Self::of(Model::of(tables)?);
        Ok(Self { graph_time: started.elapsed(), ..planner })
    }

    /// Plans on a constraint graph that was built by hand.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn from_graph(problem: Problem, graph: ConstraintGraph) -> Result<Self, ModelError> {
        Ok(Self::of(Model::with_graph(problem, graph)?))
    }

    fn of(model: Model) -> Self {
        Self::from_model(PlanningModel(Arc::new(model)))
    }

    /// Plans on a model that others may share.
    #[must_use]
    pub fn from_model(model: PlanningModel) -> Self {
        Self {
            model,
            settings: SearchSettings::default(),
            scheduler: foliate_schedulers::default_scheduler().into(),
            time_limit: None,
            memory_limit: None,
            token: CancelToken::default(),
            events: EventSink::default(),
            graph_time: Duration::ZERO,
            refinement: Refinement::default(),
            likely_impossible: None,
            recording: None,
            solves: AtomicU64::new(0),
        }
    }

    /// Sets the seed of all random streams.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.settings.seed = seed;
        self
    }

    /// Replaces all settings, the seed included.
    #[must_use]
    pub fn settings(mut self, settings: SearchSettings) -> Self {
        self.settings = settings;
        self
    }

    /// Uses another scheduler, a host's own for instance.
    #[must_use]
    pub fn scheduler(mut self, scheduler: impl Scheduler + 'static) -> Self {
        self.scheduler = Arc::new(scheduler);
        self
    }

    /// Uses a shipped scheduler by name; `None` where there is none of that name.
    #[must_use]
    pub fn scheduler_named(mut self, name: &str) -> Option<Self> {
        self.scheduler = foliate_schedulers::named(name)?.into();
        Some(self)
    }

    /// Answers with the first path, as the search finds it: without improvement and without times.
    #[must_use]
    pub fn first_path(mut self) -> Self {
        self.refinement.first = true;
        self
    }

    /// Spends so much counted work on a better path: candidates of further searches, and shortcuts that are tried. The answer is the
    /// same on any number of threads. [`ImprovementReport::work`](crate::planner::ImprovementReport::work) of an improvement that was limited by time gives its path again.
    #[must_use]
    pub fn improve_work(mut self, work: u64) -> Self {
        (self.refinement.settings.max_work, self.refinement.first) = (work, false);
        self
    }

    /// Spends so much wall time on a better path, and no limit of work.
    #[must_use]
    pub fn improve_time(mut self, time: Duration) -> Self {
        (self.refinement.time, self.refinement.first) = (Some(time), false);
        self.refinement.settings.max_work = u64::MAX;
        self
    }

    /// Replaces all settings of the improvement.
    #[must_use]
    pub fn improvement(mut self, settings: ImprovementSettings) -> Self {
        (self.refinement.settings, self.refinement.first) = (settings, false);
        self
    }

    /// Minimises a cost of the host's own instead of the problem's.
    #[must_use]
    pub fn cost(mut self, cost: impl PathCost + 'static) -> Self {
        self.refinement.cost = Some(Arc::new(cost));
        self
    }

    /// Calls a function with the first path, certified and without times, and with the model of its ids. The improvement begins when
    /// the function returns: its time counts neither for the search nor for the improvement.
    #[must_use]
    pub fn on_first_path(mut self, first: impl Fn(&PlanningModel, &ManipulationPath) + Send + Sync + 'static) -> Self {
        self.refinement.found = Some(Arc::new(first));
        self
    }

    /// Calls a function with each better path. It may cancel by the planner's token: the best path so far is the answer then.
    #[must_use]
    pub fn on_better_path(mut self, better: impl Fn(&BetterPath<'_>) + Send + Sync + 'static) -> Self {
        self.refinement.better = Some(Arc::new(better));
        self
    }

    /// Calls a function where a search finds that an object that has to be moved likely cannot be: after 8 steps of objects that no try
    /// has held, after 24 steps also of others, with the rows of the objects ([`ObjectTries::reasons`]). The search goes on.
    #[must_use]
    pub fn on_likely_impossible(mut self, told: impl Fn(&[ObjectTries]) + Send + Sync + 'static) -> Self {
        self.likely_impossible = Some(Arc::new(told));
        self
    }

    /// Gives up after this much wall time. In the search a deadline can turn an answer into none, never into another. A path that is
    /// being improved by then is answered as good as it is ([`ImprovementReport::stopped`](crate::planner::ImprovementReport::stopped));
    /// smoothing and timing it takes milliseconds on top.
    #[must_use]
    pub fn time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Ends with [`NoSolutionReason::MemoryLimit`] where the search would need more, or the process has more: see [`MemoryLimit`].
    /// Without this only [`SearchSettings::max_bytes`] bounds a search.
    #[must_use]
    pub fn memory_limit(mut self, limit: MemoryLimit) -> Self {
        self.memory_limit = Some(limit);
        self
    }

    /// Keeps what a recording needs of each search, for a file of at most [`DEFAULT_RECORDING_BYTES`]: [`Solution::record`],
    /// [`NoSolution::record`]. Answers are the same. `foliate::recording::Recording` makes a file of it.
    #[must_use]
    pub fn record(self) -> Self {
        self.record_within(DEFAULT_RECORDING_BYTES)
    }

    /// As [`Self::record`], for a file of at most so many bytes. Of a roadmap that is larger the first nodes are kept.
    #[must_use]
    pub fn record_within(mut self, bytes: u64) -> Self {
        self.recording = Some(bytes);
        self
    }

    /// Lets solves be cancelled by a token that others may hold too.
    #[must_use]
    pub fn cancelled_by(mut self, token: CancelToken) -> Self {
        self.token = token;
        self
    }

    /// The token that cancels solves of this planner from any thread.
    #[must_use]
    pub fn cancel_token(&self) -> CancelToken {
        self.token.clone()
    }

    /// Opens the channel of events. Each event carries the number of its solve ([`Report::solve`]). It holds a bounded number of unread ones and never makes the search wait.
    #[must_use]
    pub fn events(mut self) -> (Self, crossbeam_channel::Receiver<SolveEvent>) {
        let (sink, receiver) = EventSink::bounded(EVENT_CAPACITY);
        self.events = sink;
        (self, receiver)
    }

    /// The shared model: problem, graph, tables.
    #[must_use]
    pub fn model(&self) -> &PlanningModel {
        &self.model
    }

    /// A search of this problem, to be stepped by the host. It counts as a solve: its events carry a number of their own.
    #[must_use]
    pub fn search(&self) -> Search {
        self.begin(self.next_solve())
    }

    fn next_solve(&self) -> SolveId {
        SolveId(self.solves.fetch_add(1, Ordering::Relaxed))
    }

    fn begin(&self, solve: SolveId) -> Search {
        let deadline = self.time_limit.and_then(|limit| Instant::now().checked_add(limit));
        let memory = self.memory_limit.map(MemoryLimit::guard);
        let stop = StopSignal { deadline, token: self.token.clone(), memory };
        let events = self.events.of_solve(solve);
        let mut settings = self.search_settings();
        settings.log |= self.recording.is_some();
        Search::new(&self.model, self.scheduler.as_ref(), settings, stop, events)
    }

    /// The settings of a search, within the limit of memory.
    fn search_settings(&self) -> SearchSettings {
        let most = self.memory_limit.map_or(u64::MAX, |limit| limit.counted(1));
        self.settings.clone().with(|s| s.max_bytes = s.max_bytes.min(most))
    }

    /// Solves on the rayon pool in which it is called (the global one outside of any).
    ///
    /// A panic in the search, in a system of the host's for instance, does not leave it: it becomes
    /// [`NoSolutionReason::Crashed`] with what the panic said, and an empty report. The planner may go on to be used.
    ///
    /// # Errors
    /// See [`NoSolutionReason`].
    pub fn solve(&self) -> Result<Solution, NoSolution> {
        let (started, solve) = (Instant::now(), self.next_solve());
        // Nothing that a panic may leave half done is used again: a search owns its world, and what solves share is
        // immutable or filled in whole.
        catch_unwind(AssertUnwindSafe(|| self.solve_unguarded(solve))).unwrap_or_else(|panic| {
            let reason = NoSolutionReason::Crashed(panic_message(panic.as_ref()));
            Err(self.without_search(solve, reason, started.elapsed()))
        })
    }

    fn solve_unguarded(&self, solve: SolveId) -> Result<Solution, NoSolution> {
        let started = Instant::now();
        let mut search = self.begin(solve);
        let (outcome, doubts) = Doubts::run(&mut search, self.likely_impossible.as_deref());
        let path = search.path();
        let solve_time = started.elapsed();
        let record = self.recording.map(|bytes| Arc::new(SearchRecord::of(&mut search, bytes)));
        let mut report = Report { graph_time: self.graph_time, solve_time, ..Report::on(&mut search, path.as_ref()) };
        doubts.take_over(&mut report.objects);
        let model = search.model().clone();
        if let (Some(path), Some(found), SearchOutcome::Solved) = (&path, &self.refinement.found, &outcome) {
            found(&model, path);
        }
        match path.filter(|_| outcome == SearchOutcome::Solved) {
            Some(path) if self.refinement.first => Ok(Solution { path, report, model, record }),
            Some(path) => {
                let (model, path) = self.refine((model, path), started, &mut report);
                Ok(Solution { path, report, model, record })
            }
            None => Err(NoSolution { reason: NoSolutionReason::of(outcome), report: Box::new(report), model, record }),
        }
    }

    /// Improves the first path.
    fn refine(
        &self,
        (model, path): (PlanningModel, ManipulationPath),
        began: Instant,
        report: &mut Report,
    ) -> (PlanningModel, ManipulationPath) {
        let of_improvement = self.refinement.time.and_then(|time| Instant::now().checked_add(time));
        let of_solve = self.time_limit.and_then(|limit| began.checked_add(limit));
        let deadline = of_improvement.into_iter().chain(of_solve).min();
        let memory = self.memory_limit.map(MemoryLimit::guard);
        let stop = StopSignal { deadline, token: self.token.clone(), memory };
        let (model, path, improvement) =
            self.refinement.improve((model, path), &self.scheduler, &self.search_settings(), report.steps, stop);
        report.improvement = improvement;
        let started = Instant::now();
        let timed = self.timed_path(&model, &path);
        report.timing_time = started.elapsed();
        match timed {
            Ok(timed) => (model, timed),
            Err(error) => {
                report.untimed = Some(error);
                (model, path)
            }
        }
    }

    /// Smooths, times and certifies a path without times, as [`Self::solve`] does with its answer. The model is that of the path's ids:
    /// [`BetterPath::model`], [`KeptPath::model`](crate::planner::KeptPath::model).
    ///
    /// # Errors
    /// See [`TimedPathError`].
    pub fn timed_path(
        &self,
        model: &PlanningModel,
        path: &ManipulationPath,
    ) -> Result<ManipulationPath, TimedPathError> {
        timed_path(model, &self.settings, path)
    }

    /// The answer of a solve that has no search to report on.
    fn without_search(&self, solve: SolveId, reason: NoSolutionReason, solve_time: Duration) -> NoSolution {
        let report = Report { solve, graph_time: self.graph_time, solve_time, ..Report::default() };
        NoSolution { reason, report: Box::new(report), model: self.model.clone(), record: None }
    }

    /// Solves on `threads` threads of its own; the answer is the same for any number. One thread is the caller's, if that is a rayon pool of
    /// one.
    ///
    /// # Errors
    /// As [`Self::solve`], or the operating system refuses the threads.
    pub fn solve_on(&self, threads: usize) -> Result<Solution, NoSolution> {
        let wanted = threads.max(1);
        // A thread that is a pool of one already needs no other: a new one asks the system for its memory again.
        if wanted == 1 && rayon::current_thread_index().is_some() && rayon::current_num_threads() == 1 {
            return self.solve();
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(wanted).build().map_err(|error| {
            let reason = NoSolutionReason::Threads { wanted, error: Arc::new(error) };
            self.without_search(self.next_solve(), reason, Duration::ZERO)
        })?;
        pool.install(|| self.solve())
    }
}

/// What a panic says, by what `catch_unwind` gives.
#[must_use]
pub fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without a message").to_owned()
}
