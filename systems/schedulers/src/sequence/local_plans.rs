//! Joins that a straight motion could not make, planned as problems of their own.
//!
//! Of the joins that the cheapest sequence needs a few are planned in each step, by turns. What has grown is kept until the join is made,
//! so that a hard one gets more and more work, and its estimated cost rises with the work: then another sequence is the cheapest, and its
//! joins have their turn. None is given up: its cost stays finite, and where those of all other sequences have become dearer it
//! is planned again.

use crate::sequence::leaf_graph::{Join, LeafGraph};
use bevy_ecs::prelude::{Local, Query, Res, ResMut, Resource};
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::outcome::TransitionStatistics;
use foliate_components::roadmap::Roadmap;
use foliate_systems::events::StopSignal;
use foliate_systems::exploration::edges::Connection;
use foliate_systems::exploration::entities::EntityTable;
use foliate_systems::exploration::roadmap_query::RoadmapQuery;
use foliate_systems::exploration::search_log::SearchLog;
use foliate_systems::planning_model::model::PlanningModel;
use foliate_systems::runtime::parallel::each;
use foliate_systems::runtime::random::{Purpose, stream};
use foliate_systems::runtime::scratch_pool::ScratchPool;
use foliate_systems::schedule::StepCounter;
use foliate_systems::settings::SearchSettings;
use foliate_systems::step::local_planner::leaf_space::{LeafScratch, LeafSpace, MotionAttempt};
use foliate_systems::step::local_planner::rrt_connect::{LocalPlan, PlannedMotion};
use std::collections::BTreeMap;

/// Work on a join in one step: the first time, and at most. It is as much as was done before, so that a join that cannot be made costs
/// little at first.
const FIRST: u64 = 16;
const MOST: u64 = 32;

/// Joins that are planned in one step.
const AT_ONCE: usize = 4;

/// Work that makes up one effort.
const EFFORT: f64 = 16.0;

/// Work after which the trees of a join begin anew for the first time; each time it is twice as much.
const RESTART_WORK: u64 = 8192;

/// Memory of all trees from which on those of joins that have no turn are dropped, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// The joins that a straight motion could not make, of the sequence that is worked on.
#[derive(Clone, Debug, Default, Resource)]
pub struct BlockedJoins(pub Vec<Join>);

/// What has grown for joins that are not made yet.
#[derive(Clone, Debug, Default, Resource)]
pub struct LocalPlans {
    plans: BTreeMap<Join, LocalPlan>,
    /// Joins whose trees have begun anew, and after how much work they will again.
    restarts: BTreeMap<Join, u64>,
    /// Connections that have been planned in this step.
    pub(crate) made: Vec<Connection>,
}

impl LocalPlans {
    /// About how much memory it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.plans.values().map(LocalPlan::bytes).sum()
    }
}

/// The trees of a join in this step.
struct Turn {
    join: Join,
    plan: LocalPlan,
    /// Work that had been done before.
    before: u64,
    planned: Option<PlannedMotion>,
}

/// Lets the trees of joins grow that the cheapest sequence needs.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn plan_joins(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    mut step: ResMut<'_, StepCounter>,
    leaves: Res<'_, LeafIndex>,
    roadmap: RoadmapQuery<'_, '_>,
    blocked: Res<'_, BlockedJoins>,
    mut graph: ResMut<'_, LeafGraph>,
    mut plans: ResMut<'_, LocalPlans>,
    table: Res<'_, EntityTable>,
    mut statistics: Query<'_, '_, &mut TransitionStatistics>,
    mut log: Option<ResMut<'_, SearchLog>>,
    buffers: Local<'_, ScratchPool<LeafScratch>>,
) {
    let roadmap = roadmap.view();
    let mut turns = plans.take_turns(roadmap, &graph, &blocked.0, step.step);
    let (buffers, number) = (&*buffers, step.step);
    each(
        &mut turns,
        || buffers.borrow(),
        |scratch, Turn { join, plan, planned, .. }| {
            if stop.is_raised() {
                return;
            }
            let Some(leaf) = LeafSpace::new(&model, &settings, &leaves, graph.leaf(*join)) else { return };
            let (a, b) = graph.ends(*join);
            let ends = (roadmap.configuration(a), roadmap.configuration(b));
            let mut rng = stream(settings.seed, Purpose::JOIN, number, join.0.rotate_left(16) ^ join.1);
            *planned = plan.grow(&leaf, ends, plan.work.clamp(FIRST, MOST), &mut rng, scratch);
        },
    );
    for Turn { join, mut plan, before, planned } in turns {
        step.connections += plan.work - before;
        let attempts = std::mem::take(&mut plan.attempts);
        let along = model.graph.loop_of(roadmap.node(graph.ends(join).0).state);
        if let Some(along) = along
            && let Ok(mut statistics) = statistics.get_mut(table.transitions[along.at()])
        {
            attempts.iter().for_each(|attempt| count(&mut statistics, attempt));
            let blocked = attempts.iter().filter_map(|attempt| attempt.blocked_by.zip(attempt.blocked_at.as_deref()));
            if let Some(log) = &mut log {
                blocked.for_each(|(pair, q)| log.note_collision((along, pair), q));
            }
        }
        if let Some(PlannedMotion { from, to, motion }) = planned {
            plans.made.push(Connection { from, to, verdict: Some(Ok(vec![motion])) });
        } else {
            // A leaf on which nothing can be planned counts as if it had been tried.
            graph.count_failure(join, (plan.work - before).max(FIRST) as f64 / EFFORT);
            plans.plans.insert(join, plan);
        }
    }
}

/// Counts a motion of a plan as an extension along the loop of its state.
fn count(statistics: &mut TransitionStatistics, attempt: &MotionAttempt) {
    statistics.attempts += 1;
    match attempt.rejected {
        None => statistics.reached += 1,
        Some(reason) => {
            statistics.partial += u64::from(attempt.is_kept);
            statistics.count_rejection(reason, attempt.blocked_by);
        }
    }
}

impl LocalPlans {
    /// The joins whose turn it is, out of those that the sequence needs; forgets those that have been made.
    fn take_turns(&mut self, roadmap: Roadmap<'_>, graph: &LeafGraph, needed: &[Join], step: u64) -> Vec<Turn> {
        let is_apart = |join: Join| {
            let (a, b) = graph.ends(join);
            roadmap.tree_of(a) != roadmap.tree_of(b)
        };
        self.plans.retain(|&join, _| is_apart(join));
        let mut needed: Vec<Join> = needed.iter().copied().filter(|&join| is_apart(join)).collect();
        let first = step as usize % needed.len().max(1);
        needed.rotate_left(first);
        needed.truncate(AT_ONCE);
        let turns = needed.into_iter().map(|join| {
            let (a, b) = graph.ends(join);
            let most = self.restarts.get(&join).copied().unwrap_or(RESTART_WORK);
            let begun = self.plans.remove(&join);
            if begun.as_ref().is_some_and(|plan| plan.work >= most) {
                self.restarts.insert(join, 2 * most);
            }
            let begun = begun.filter(|plan| plan.work < most);
            let begin = || LocalPlan::between([a, b].map(|node| (node, roadmap.configuration(node))));
            let plan = begun.unwrap_or_else(begin);
            Turn { join, before: plan.work, plan, planned: None }
        });
        let turns = turns.collect();
        if self.bytes() > MOST_BYTES {
            self.plans.clear();
        }
        turns
    }
}
