//! The facade: a problem in, a certified path or a reason out.

use crate::memory::MemoryLimit;
use foliate_components::graph::{ConstraintGraph, StateId, TransitionId};
use foliate_components::outcome::{
    BlockingParts, GoalStatistics, Prior, SearchOutcome, StateStatistics, TransitionStatistics,
};
use foliate_components::path::ManipulationPath;
use foliate_components::problem::Problem;
use foliate_components::robot::PartIndex;
use foliate_schedulers::Scheduler;
use foliate_schedulers::portfolio::{MemberCount, MemberCounts};
use foliate_systems::events::{CancelToken, EventSink, SearchEvent, StopSignal};
use foliate_systems::planning_model::{Model, ModelError, PlanningModel, ProblemTables};
use foliate_systems::search::Search;
use foliate_systems::search::path_clearance::{PathClearance, path_clearance};
use foliate_systems::settings::SearchSettings;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
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
}

/// What a solve returns.
#[derive(Clone, Debug)]
pub struct Solution {
    /// How the search ended.
    pub outcome: SearchOutcome,
    /// The path, where it is solved.
    pub path: Option<ManipulationPath>,
    /// What the search did.
    pub report: Report,
    /// The model whose graph the path's ids are of: the planner's own, or, where its graph is lazy, as far as this search has
    /// made it grow.
    pub model: PlanningModel,
}

impl Solution {
    /// How close things come along the path, and where: of all tested pairs of shapes the least distance beyond the margins, bounded
    /// from below to within a tenth of it or 0.1 mm. `None` without a path, and where no pair is tested.
    ///
    /// The search proves no more than that nothing touches, and that is what the path's certificate says at first; this takes
    /// milliseconds on top.
    #[must_use]
    pub fn clearance(&self) -> Option<PathClearance> {
        path_clearance(&self.model, self.path.as_ref()?)
    }

    /// As [`Self::clearance`], and from then on the path's certificate says the better bound.
    pub fn measure_clearance(&mut self) -> Option<PathClearance> {
        let found = self.clearance()?;
        if let Some(path) = &mut self.path {
            path.certificate.min_clearance = Some(found.lower);
        }
        Some(found)
    }
}

/// What a search did. Wall times are of this run; everything else depends on problem, settings and seed alone.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Wall time of building the constraint graph, where this planner did: all its solves share it.
    pub graph_time: Duration,
    /// Wall time of the search, from the prepared model to the certified path.
    pub solve_time: Duration,
    /// Steps, of all portfolio members where there are several.
    pub steps: u64,
    /// Candidates, of all members.
    pub candidates: u64,
    /// Candidates whose waypoints all projected, whether or not these were free, of all members.
    pub validated: u64,
    /// What each member of a portfolio did (scheduler `portfolio`); empty where the search had but one. What follows is of the one
    /// that answers.
    pub worlds: Vec<MemberCount>,
    /// Roadmap nodes.
    pub nodes: usize,
    /// Roadmap edges.
    pub edges: usize,
    /// Leaves reached.
    pub leaves: usize,
    /// Hash of the whole roadmap, equal for any number of threads.
    pub fingerprint: u64,
    /// Weighted length of the path, metres.
    pub path_length: Option<f64>,
    /// What became of the candidates, by transition.
    pub funnel: Vec<FunnelRow>,
    /// What the search has of the states that it has reached or started from.
    pub states: Vec<StateRow>,
    /// What became of the tries to find configurations for goals that leave something free.
    pub goals: GoalReport,
}

/// One transition's row of the funnel.
#[derive(Clone, Debug)]
pub struct FunnelRow {
    /// Name of the transition.
    pub transition: String,
    /// Counts.
    pub statistics: TransitionStatistics,
    /// How often a candidate reached the target, by Laplace's rule.
    pub success_rate: f64,
    /// How often the waypoints of a candidate could be projected, by Laplace's rule.
    pub projection_rate: f64,
    /// Pairs of shapes that stopped candidates, most frequent first.
    pub blocked_by: Vec<(String, String, u64)>,
    /// The same by parts: which object was in the way.
    pub blocking_parts: Vec<(String, String, u64)>,
}

/// One state's row.
#[derive(Clone, Debug)]
pub struct StateRow {
    /// Name of the state.
    pub state: String,
    /// Counts.
    pub statistics: StateStatistics,
}

/// How the goals that leave something free fared.
#[derive(Clone, Debug, Default)]
pub struct GoalReport {
    /// Counts.
    pub statistics: GoalStatistics,
    /// Pairs of parts that collided, most frequent first.
    pub blocking_parts: Vec<(String, String, u64)>,
}

impl Report {
    /// Wall time from the loaded problem, with the bounds of its shapes, to the certified path.
    #[must_use]
    pub fn time(&self) -> Duration {
        self.graph_time + self.solve_time
    }
}

impl Planner {
    /// Prepares to plan: builds the constraint graph and the tables.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn new(problem: Problem) -> Result<Self, ModelError> {
        Self::of_tables(Arc::new(ProblemTables::new(problem)))
    }

    /// As [`Self::new`], where the tables of the problem are there already: builds the constraint graph.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn of_tables(tables: Arc<ProblemTables>) -> Result<Self, ModelError> {
        let started = Instant::now();
        let planner = Self::with_model(Model::of(tables)?);
        Ok(Self { graph_time: started.elapsed(), ..planner })
    }

    /// Plans on a constraint graph that was built by hand.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn with_graph(problem: Problem, graph: ConstraintGraph) -> Result<Self, ModelError> {
        Ok(Self::with_model(Model::with_graph(problem, graph)?))
    }

    fn with_model(model: Model) -> Self {
        Self::of_model(PlanningModel(Arc::new(model)))
    }

    /// Plans on a model that others may share.
    #[must_use]
    pub fn of_model(model: PlanningModel) -> Self {
        Self {
            model,
            settings: SearchSettings::default(),
            scheduler: foliate_schedulers::default_scheduler().into(),
            time_limit: None,
            memory_limit: None,
            token: CancelToken::default(),
            events: EventSink::default(),
            graph_time: Duration::ZERO,
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

    /// Gives up after this much wall time. A deadline can turn an answer into none, never into another.
    #[must_use]
    pub fn time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Ends with [`SearchOutcome::MemoryLimit`] where the search would need more, or the process has more: see [`MemoryLimit`].
    /// Without this only [`SearchSettings::max_bytes`] bounds a search.
    #[must_use]
    pub fn memory_limit(mut self, limit: MemoryLimit) -> Self {
        self.memory_limit = Some(limit);
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

    /// Opens the channel of events. It holds a bounded number of unread ones and never makes the search wait.
    #[must_use]
    pub fn events(mut self) -> (Self, crossbeam_channel::Receiver<SearchEvent>) {
        let (sink, receiver) = EventSink::bounded(EVENT_CAPACITY);
        self.events = sink;
        (self, receiver)
    }

    /// The shared model: problem, graph, tables.
    #[must_use]
    pub fn model(&self) -> &PlanningModel {
        &self.model
    }

    /// A search of this problem, to be stepped by the host.
    #[must_use]
    pub fn search(&self) -> Search {
        let deadline = self.time_limit.and_then(|limit| Instant::now().checked_add(limit));
        let memory = self.memory_limit.map(MemoryLimit::guard);
        let stop = StopSignal { deadline, token: self.token.clone(), memory };
        let mut settings = self.settings.clone();
        settings.max_bytes = self.memory_limit.map_or(u64::MAX, |limit| limit.counted(1)).min(settings.max_bytes);
        Search::new(&self.model, self.scheduler.as_ref(), settings, stop, self.events.clone())
    }

    /// Solves on the rayon pool in which it is called (the global one outside of any).
    ///
    /// A panic in the search, in a system of the host's for instance, does not leave it: the outcome is then
    /// [`SearchOutcome::Crashed`] with what the panic said, and the report is empty. The planner may go on to be used.
    #[must_use]
    pub fn solve(&self) -> Solution {
        let started = Instant::now();
        // Nothing that a panic may leave half done is used again: a search owns its world, and what solves share is
        // immutable or filled in whole.
        catch_unwind(AssertUnwindSafe(|| self.solve_unguarded())).unwrap_or_else(|panic| Solution {
            outcome: SearchOutcome::Crashed(panic_message(panic.as_ref())),
            path: None,
            report: Report { graph_time: self.graph_time, solve_time: started.elapsed(), ..Report::default() },
            model: self.model.clone(),
        })
    }

    fn solve_unguarded(&self) -> Solution {
        let started = Instant::now();
        let mut search = self.search();
        let outcome = search.run();
        let path = search.path();
        let solve_time = started.elapsed();
        let mut report = self.report(&mut search, path.as_ref());
        report.solve_time = solve_time;
        let model = search.model().clone();
        Solution { outcome, path, report, model }
    }

    /// Solves on `threads` threads of its own; the answer is the same for any number.
    ///
    /// # Errors
    /// The operating system refuses the threads.
    pub fn solve_on(&self, threads: usize) -> Result<Solution, rayon::ThreadPoolBuildError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).build()?;
        Ok(pool.install(|| self.solve()))
    }

    fn report(&self, search: &mut Search, path: Option<&ManipulationPath>) -> Report {
        let worlds = search.world().get_resource::<MemberCounts>().map(|counts| counts.0.clone()).unwrap_or_default();
        let counter = match worlds.is_empty() {
            true => search.counter(),
            false => worlds.iter().map(|world| world.counter).sum(),
        };
        let funnel = search.statistics().into_iter().filter(|(_, s)| s.attempts > 0);
        let model = search.model().clone();
        let funnel = funnel.map(|(id, statistics)| funnel_row(&model, id, statistics)).collect();
        let states = search.states().into_iter().filter(|(_, s)| *s != StateStatistics::default());
        let name = |state: StateId| model.graph.state(state).name.clone();
        let states = states.map(|(id, statistics)| StateRow { state: name(id), statistics }).collect();
        let statistics = search.goal_statistics().clone();
        let blocking_parts = part_names(&model, &statistics.blocking_parts(&model.problem.robot));
        let roadmap = search.roadmap();
        Report {
            graph_time: self.graph_time,
            solve_time: Duration::ZERO,
            steps: counter.step,
            candidates: counter.candidates,
            validated: counter.validated,
            worlds,
            nodes: roadmap.nodes().len(),
            edges: roadmap.edges().len(),
            leaves: search.world().resource::<foliate_components::graph::leaf::LeafIndex>().leaves().len(),
            fingerprint: roadmap.fingerprint(),
            path_length: path.map(|p| p.segments.iter().map(|s| self.model.length(&s.knots.concat())).sum()),
            funnel,
            states,
            goals: GoalReport { statistics, blocking_parts },
        }
    }
}

/// What a panic says.
pub(crate) fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without a message").to_owned()
}

fn funnel_row(model: &PlanningModel, transition: TransitionId, statistics: TransitionStatistics) -> FunnelRow {
    let shape = |s: foliate_components::robot::ShapeIndex| model.problem.robot.shapes[s.at()].name.clone();
    let mut blocked_by: Vec<_> = statistics.blocked_by.iter().map(|(&(a, b), &n)| (shape(a), shape(b), n)).collect();
    blocked_by.sort_by(|x, y| y.2.cmp(&x.2).then_with(|| x.cmp(y)));
    FunnelRow {
        transition: model.graph.transition(transition).name.clone(),
        success_rate: statistics.success_rate(Prior::default()),
        projection_rate: statistics.projection_rate(Prior::default()),
        blocking_parts: part_names(model, &statistics.blocking_parts(&model.problem.robot)),
        statistics,
        blocked_by,
    }
}

fn part_names(model: &PlanningModel, pairs: &[BlockingParts]) -> Vec<(String, String, u64)> {
    let name = |part: PartIndex| model.problem.robot.parts[part.0 as usize].name.clone();
    pairs.iter().map(|pair| (name(pair.first), name(pair.second), pair.count)).collect()
}
