//! `mrrt`: Manipulation RRT, the papers' algorithm (P0 Alg. 1, P1 §III), batched.

use foliate_systems::heuristic::systems;
use foliate_systems::search::scheduler::Scheduler;
use foliate_systems::step::connection::connect;
use foliate_systems::step::projection::project;

use bevy_ecs::prelude::{IntoScheduleConfigs, Schedule, World};
use foliate_systems::schedule::{SearchSet, empty_schedule};
use foliate_systems::step::{commit, conclusion, rendezvous, sampling, selection, steering, validation, waypoints};

/// Random trees from the start and every goal, grown leaf by leaf through regular and crossed transitions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mrrt;

impl Scheduler for Mrrt {
    fn name(&self) -> &'static str {
        "mrrt"
    }

    fn schedule(&self, _world: &mut World) -> Schedule {
        let mut schedule = empty_schedule();
        schedule.add_systems((
            (sampling::reset_candidates, sampling::sample_configurations).chain().in_set(SearchSet::Sample),
            (
                selection::gather_weights,
                systems::measure_leaves,
                systems::choose_leaves,
                selection::select_nodes,
                selection::select_transitions,
            )
                .chain()
                .in_set(SearchSet::Select),
            rendezvous::draw_leaves.in_set(SearchSet::Rendezvous),
            project::project_waypoints.in_set(SearchSet::Project),
            (waypoints::check_waypoints, steering::steer_legs).chain().in_set(SearchSet::Steer),
            validation::certify_legs.in_set(SearchSet::Validate),
            (commit::commit_extensions, foliate_systems::goals::systems::draw_more_goals)
                .chain()
                .in_set(SearchSet::Commit),
            (connect::propose_connections, connect::certify_connections, commit::commit_connections)
                .chain()
                .in_set(SearchSet::Connect),
            (
                conclusion::conclude,
                conclusion::report_progress,
                conclusion::report_feedback,
                conclusion::report_solution,
            )
                .chain()
                .in_set(SearchSet::Conclude),
        ));
        schedule
    }
}
