//! The world of a search before its first step: all resources, and start and goals as roots of trees.
//!
//! It names every resource that a system of the crate may read, and therefore depends on all modules that define one.

use crate::events::{EventSink, StopSignal};
use crate::exploration::edges::{Connections, UnvalidatedByEnd};
use crate::exploration::entities::{NewNodes, TransitionWeights};
use crate::exploration::memory::{Compiled, PlacementBytes, SchedulerBytes};
use crate::exploration::neighbours::index::Neighbours;
use crate::exploration::reached_leaves::ReachedLeaves;
use crate::exploration::roadmap_query::{insert_roadmap, roadmap_in};
use crate::exploration::roots::{Ending, GivenRoots, Roots};
use crate::exploration::search_log::SearchLog;
use crate::exploration::writer;
use crate::goals::impossible::proofs;
use crate::goals::sampler::GoalSampler;
use crate::goals::systems::add_start_and_goals;
use crate::heuristic::placements::PlacementPool;
use crate::planning_model::graph::connected_states::connected_states;
use crate::planning_model::model::PlanningModel;
use crate::planning_model::state_classification;
use crate::planning_model::state_classification::Feasible;
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Mut, World};
use foliate_components::candidate::CandidateArena;
use foliate_components::graph::StateId;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::infeasibility::Infeasibility;
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::Goal;

/// A world with all resources in place, and no roots.
pub(crate) fn empty_world(
    model: &PlanningModel,
    settings: SearchSettings,
    stop: StopSignal,
    events: EventSink,
) -> World {
    let mut world = World::new();
    let settings = settings.for_problem(&model.problem);
    let size = model.problem.robot.space.size();
    let candidates = settings.candidates.clamp(1, 4096);
    world.insert_resource(model.clone());
    writer::spawn_graph_and_candidates(&mut world, candidates);
    world.insert_resource(CandidateArena::new(candidates, size));
    insert_roadmap(&mut world, size);
    world.init_resource::<LeafIndex>();
    world.init_resource::<NewNodes>();
    world.init_resource::<Connections>();
    world.init_resource::<UnvalidatedByEnd>();
    world.init_resource::<SchedulerBytes>();
    world.init_resource::<PlacementBytes>();
    world.init_resource::<Compiled>();
    world.init_resource::<ReachedLeaves>();
    world.init_resource::<crate::heuristic::leaf_heuristic::LeafHeuristic>();
    world.init_resource::<crate::heuristic::blocking::MoveOrder>();
    world.init_resource::<TransitionWeights>();
    world.init_resource::<StepCounter>();
    world.init_resource::<Roots>();
    world.init_resource::<GivenRoots>();
    world.init_resource::<Ending>();
    world.init_resource::<GoalSampler>();
    world.init_resource::<PlacementPool>();
    world.insert_resource(Neighbours::new(model, &settings));
    if settings.log {
        world.init_resource::<SearchLog>();
    }
    world.insert_resource(settings);
    world.insert_resource(stop);
    world.insert_resource(events);
    world
}

/// Start and goals as they stand in a world.
pub(crate) fn roots_in(world: &World) -> (Option<Feasible>, Vec<Feasible>) {
    let (roadmap, leaves, roots) = (roadmap_in(world), world.resource::<LeafIndex>(), world.resource::<Roots>());
    let root = |node| {
        let row = roadmap.node(node);
        let parameters = leaves.leaf(row.leaf).parameters.iter().map(|&id| *leaves.parameter(id)).collect();
        let given = world.resource::<GivenRoots>().of(node).map(<[f64]>::to_vec);
        Feasible { q: roadmap.configuration(node).to_vec(), state: row.state, parameters, given }
    };
    (roots.start.map(root), roots.goals.iter().copied().map(root).collect())
}

/// Makes start and goals the roots of trees. A goal that leaves something free and of which no configuration was found yet
/// is looked for again during the search.
pub(crate) fn add_roots(world: &mut World) -> Result<(), SearchOutcome> {
    let settings = world.resource::<SearchSettings>().clone();
    let found = world.resource_scope(|world, mut model: Mut<'_, PlanningModel>| {
        find_roots(&mut model, &settings, world.resource::<StopSignal>())
    })?;
    world.insert_resource(found.sampler);
    if let Some(why) = found.hopeless {
        return Err(SearchOutcome::InfeasibleGoal(why));
    }
    add_start_and_goals(world, Some(found.start), found.goals);
    Ok(())
}

/// Where trees begin.
struct FoundRoots {
    start: Feasible,
    goals: Vec<Feasible>,
    sampler: GoalSampler,
    /// Why there is no goal and will be none.
    hopeless: Option<Infeasibility>,
}

fn find_roots(
    model: &mut PlanningModel,
    settings: &SearchSettings,
    stop: &StopSignal,
) -> Result<FoundRoots, SearchOutcome> {
    let q = model.problem.start.clone();
    let start = state_classification::reach_start(model, settings, &q).map_err(SearchOutcome::InfeasibleStart)?;
    // Of a lazy graph all that has not come into being may join what has.
    let is_connected = (!model.graph.lazy).then(|| connected_states(&model.graph, start.state, |_| true));
    let may_reach = |state: StateId| is_connected.as_ref().is_none_or(|is_connected| is_connected[state.at()]);
    let mut sampler = GoalSampler::new(model, settings, &start.q, may_reach);
    let mut goals = Vec::new();
    let mut complaint = Infeasibility::NoGoal;
    let mut is_refused = false;
    for goal in model.problem.goals.clone() {
        if let Goal::Configuration(q) = goal {
            match state_classification::reach_feasible(model, settings, &q) {
                Ok(goal) if may_reach(goal.state) => goals.push(goal),
                Ok(goal) => complaint = apart(model, start.state, goal.state),
                Err(why) => (complaint, is_refused) = (why, true),
            }
        }
    }
    // What is wrong with a configuration itself is told first: bounds, collisions, states.
    let is_complaint_enough = is_refused && goals.is_empty() && sampler.is_empty();
    if !is_complaint_enough && let Some(why) = proofs::refute(model, settings, &start) {
        return Err(SearchOutcome::InfeasibleGoal(why));
    }
    goals.extend(sampler.draw_first(model, settings, stop));
    let given_up = sampler.given_up(model, settings);
    let hopeless = goals.is_empty() && (sampler.is_empty() || given_up.is_some());
    let hopeless = hopeless.then(|| given_up.unwrap_or(complaint));
    Ok(FoundRoots { start, goals, sampler, hopeless })
}

/// That no transitions lead from one state to another.
fn apart(model: &PlanningModel, start: StateId, goal: StateId) -> Infeasibility {
    let name = |state: StateId| model.graph.state(state).name.clone();
    Infeasibility::GoalStateApart { start: name(start), goal: name(goal) }
}
