//! What a search did, for a host: counts, times, and what became of the candidates.

use crate::planner::object_tries::{ObjectTries, object_tries};
use crate::planner::refinement::ImprovementReport;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::{BlockingParts, GoalStatistics, Prior, StateStatistics, TransitionStatistics};
use foliate_components::path::ManipulationPath;
use foliate_components::problem::Correction;
use foliate_components::robot::{PartIndex, ShapeIndex};
use foliate_schedulers::portfolio::{MemberCount, MemberCounts};
use foliate_systems::events::{EventSink, SolveId};
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::Search;
use foliate_systems::trajectory::TimedPathError;
use std::time::Duration;

/// What a search did. Wall times and the number of the solve are of this run; everything else depends on problem, settings and
/// seed alone.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Report {
    /// Which solve of the planner it was; its events carry the same number.
    pub solve: SolveId,
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
    /// Weighted length of the first path, metres.
    pub path_length: Option<f64>,
    /// What its improvement has done; `None` where there was none.
    pub improvement: Option<ImprovementReport>,
    /// Wall time of smoothing, timing and certifying the curve.
    pub timing_time: Duration,
    /// What of the start and the goals was off a state by less than [`Problem::start_tolerance`](crate::components::problem::Problem)
    /// and was moved onto it: objects, and joints where only they could be.
    pub snapped: Vec<Correction>,
    /// Why the path has no times although they were wanted.
    pub untimed: Option<TimedPathError>,
    /// What became of the candidates, by transition.
    pub funnel: Vec<FunnelRow>,
    /// What the search has of the states that it has reached or started from.
    pub states: Vec<StateRow>,
    /// What became of the tries to find configurations for goals that leave something free.
    pub goals: GoalReport,
    /// What became of the tries to grasp each object that has to be moved.
    pub objects: Vec<ObjectTries>,
}

/// One transition's row of the funnel.
#[derive(Clone, Debug)]
#[non_exhaustive]
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
#[non_exhaustive]
pub struct StateRow {
    /// Name of the state.
    pub state: String,
    /// Counts.
    pub statistics: StateStatistics,
}

/// How the goals that leave something free fared.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
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

    /// The report on a search that has ended.
    pub(crate) fn on(search: &mut Search, path: Option<&ManipulationPath>) -> Self {
        let worlds = search.world().get_resource::<MemberCounts>().map(|counts| counts.0.clone()).unwrap_or_default();
        let counter = match worlds.is_empty() {
            true => search.counter(),
            false => worlds.iter().map(|world| world.counter).sum(),
        };
        let statistics = search.statistics();
        let model = search.model().clone();
        let objects = object_tries(&model, &statistics);
        let funnel = statistics.into_iter().filter(|(_, s)| s.attempts > 0);
        let funnel = funnel.map(|(id, statistics)| funnel_row(&model, id, statistics)).collect();
        let states = search.states().into_iter().filter(|(_, s)| *s != StateStatistics::default());
        let name = |state: StateId| model.graph.state(state).name.clone();
        let states = states.map(|(id, statistics)| StateRow { state: name(id), statistics }).collect();
        let statistics = search.goal_statistics().clone();
        let blocking_parts = part_names(&model, &statistics.blocking_parts(&model.problem.robot));
        let roadmap = search.roadmap();
        Self {
            solve: search.world().resource::<EventSink>().solve(),
            graph_time: Duration::ZERO,
            solve_time: Duration::ZERO,
            steps: counter.step,
            candidates: counter.candidates,
            validated: counter.validated,
            worlds,
            nodes: roadmap.nodes().len(),
            edges: roadmap.edges().len(),
            leaves: search.world().resource::<LeafIndex>().leaves().len(),
            fingerprint: roadmap.fingerprint(),
            path_length: path.map(|p| p.segments.iter().map(|s| model.length(&s.knots.concat())).sum()),
            improvement: None,
            timing_time: Duration::ZERO,
            snapped: model.snapped.clone(),
            untimed: None,
            funnel,
            states,
            goals: GoalReport { statistics, blocking_parts },
            objects,
        }
    }
}

fn funnel_row(model: &PlanningModel, transition: TransitionId, statistics: TransitionStatistics) -> FunnelRow {
    let shape = |s: ShapeIndex| model.problem.robot.shapes[s.at()].name.clone();
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
