//! `mrrt`: Manipulation RRT, the papers' algorithm (P0 Alg. 1, P1 §III), batched.

use bevy_ecs::prelude::{Schedule, World};
use foliate_systems::goals::systems::draw_more_goals;
use foliate_systems::heuristic::placements::systems::{aim_at_placements, learn_from_placements};
use foliate_systems::heuristic::systems;
use foliate_systems::schedule::{SearchSet, StepSystems};
use foliate_systems::search::scheduler::Scheduler;
use foliate_systems::step::connection::connect;
use foliate_systems::step::projection::project;
use foliate_systems::step::{commit, conclusion, rendezvous, sampling, selection, steering, validation, waypoints};

/// Random trees from the start and every goal, grown leaf by leaf through regular and crossed transitions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mrrt;

impl Scheduler for Mrrt {
    fn name(&self) -> &'static str {
        "mrrt"
    }

    fn schedule(&self, _world: &mut World) -> Schedule {
        // One by one, so that a host can put systems between them: this is the scheduler to build on.
        step_systems().expanded(true)
    }
}

/// The systems of a step.
#[must_use]
pub fn step_systems() -> StepSystems {
    StepSystems::new()
        .in_set(SearchSet::Sample, (sampling::reset_candidates, sampling::sample_configurations))
        .in_set(
            SearchSet::Select,
            (
                selection::gather_weights,
                systems::measure_leaves,
                systems::choose_leaves,
                aim_at_placements,
                selection::select_nodes,
                selection::select_transitions,
            ),
        )
        .in_set(SearchSet::Rendezvous, (rendezvous::draw_leaves,))
        .in_set(SearchSet::Project, (project::project_waypoints,))
        .in_set(SearchSet::Steer, (waypoints::check_waypoints, steering::steer_legs))
        .in_set(SearchSet::Validate, (validation::certify_legs, learn_from_placements))
        .in_set(SearchSet::Commit, (commit::commit_extensions, draw_more_goals))
        .in_set(
            SearchSet::Connect,
            (connect::propose_connections, connect::certify_connections, commit::commit_connections),
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
