//! `sequence`: sequences of transitions first, long motions last.

use crate::sequence::{connect_iterations, lazy_extension};
use foliate_systems::goals::systems::draw_more_goals;
use foliate_systems::heuristic::blocking::systems::{aim_at_buffers, begin_order, learn_reach};
use foliate_systems::heuristic::placements::systems::{aim_at_placements, learn_from_placements};
use foliate_systems::heuristic::systems;
use foliate_systems::search::PlanAgain;
use foliate_systems::search::scheduler::Scheduler;
use foliate_systems::step::projection::project;

use crate::sequence::{foundations, joining, leaf_graph, local_plans};
use bevy_ecs::prelude::{Schedule, World};
use foliate_components::graph::TransitionKind;
use foliate_systems::planning_model::model::PlanningModel;
use foliate_systems::schedule::{SearchSet, StepSystems};
use foliate_systems::step::lazy_extension as lazy;
use foliate_systems::step::{commit, conclusion, rendezvous, sampling, selection, steering, validation, waypoints};
use std::sync::Arc;

/// Trees are extended lazily, by short motions between leaves, where `mrrt` would first certify how to get there; only the long motions of
/// sequences that reach from the start to a goal are certified, those estimated to be easiest first. Where these
/// are not free, they are planned as problems of their own. A problem whose only transitions are loops reduces to one such motion.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequence;

impl Scheduler for Sequence {
    fn name(&self) -> &'static str {
        "sequence"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        insert_resources(world);
        let systems = if stays_on_its_leaf(world) { plain_systems() } else { step_systems() };
        systems.schedule()
    }
}

/// Adds the resources that [`step_systems`] read beside those of every world.
pub fn insert_resources(world: &mut World) {
    world.init_resource::<leaf_graph::LeafGraph>();
    world.init_resource::<lazy_extension::LazyExtensions>();
    world.init_resource::<local_plans::BlockedJoins>();
    world.init_resource::<local_plans::LocalPlans>();
    world.init_resource::<joining::Tried>();
    world.init_resource::<foundations::Foundations>();
    world.init_resource::<connect_iterations::ConnectIterations>();
    world.insert_resource(PlanAgain(Arc::new(Sequence)));
}

/// The systems of a step. [`insert_resources`] adds what they read.
#[must_use]
pub fn step_systems() -> StepSystems {
    joined_and_concluded(
        StepSystems::new()
            .in_set(SearchSet::Sample, (sampling::reset_candidates, sampling::sample_configurations, begin_order))
            .in_set(
                SearchSet::Select,
                (
                    lazy_extension::rest,
                    selection::gather_weights,
                    systems::measure_leaves,
                    systems::choose_leaves,
                    aim_at_placements,
                    selection::select_nodes,
                    lazy_extension::choose_lazy_extensions,
                    selection::select_transitions,
                ),
            )
            .in_set(SearchSet::Rendezvous, (aim_at_buffers, rendezvous::draw_leaves, lazy_extension::stay_near))
            .in_set(SearchSet::Project, (project::project_waypoints, lazy::leave_out_first_legs))
            .in_set(SearchSet::Steer, (waypoints::check_waypoints, steering::steer_legs, lazy::drop_cut_short))
            .in_set(
                SearchSet::Validate,
                (validation::certify_legs, lazy_extension::count_outcomes, learn_from_placements, learn_reach),
            )
            .in_set(SearchSet::Commit, (commit::commit_extensions, draw_more_goals)),
    )
}

/// The systems of a step where there is one leaf alone: nothing is extended, the trees of start and goals are joined.
fn plain_systems() -> StepSystems {
    joined_and_concluded(
        StepSystems::new()
            .in_set(SearchSet::Sample, (sampling::reset_candidates, lazy_extension::rest_all))
            .in_set(SearchSet::Commit, (commit::commit_extensions, draw_more_goals)),
    )
}

/// Adds what both kinds of steps end with.
fn joined_and_concluded(systems: StepSystems) -> StepSystems {
    systems
        .in_set(
            SearchSet::Connect,
            (local_plans::plan_joins, connect_iterations::join_iteratively, connect_iterations::count_memory),
        )
        .in_set(
            SearchSet::Conclude,
            (
                conclusion::conclude,
                conclusion::report_progress,
                conclusion::report_feedback,
                conclusion::report_solution,
            ),
        )
}

/// Whether every transition is a loop, so that all sequences are empty and there is nothing to extend lazily: plain motion planning.
fn stays_on_its_leaf(world: &World) -> bool {
    let graph = &world.resource::<PlanningModel>().graph;
    !graph.lazy && graph.transitions.iter().all(|transition| transition.kind == TransitionKind::Loop)
}
