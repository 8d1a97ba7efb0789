//! `sequence`: sequences of transitions first, long motions last.

use super::Scheduler;
use super::mrrt::Mrrt;
use crate::guidance::aiming;
use crate::model::PlanningModel;
use crate::schedule::{SearchSet, empty_schedule};
use crate::sequences::{joining, leaf_graph, planting, rounds};
use crate::{
    commit, conclusion, feedback, goals, projection, rendezvous, sampling, selection, steering, validation, waypoints,
};
use bevy_ecs::prelude::{IntoScheduleConfigs, Schedule, World};
use foliate_components::graph::TransitionKind;

/// Short motions between leaves are planted where `mrrt` would first certify how to get there; only the long motions of
/// sequences that reach from the start to a goal are certified, those estimated to be easiest first. A problem whose only
/// transitions are loops has no sequences: it is left to [`Mrrt`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequence;

impl Scheduler for Sequence {
    fn name(&self) -> &'static str {
        "sequence"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        if stays_on_its_leaf(world) {
            return Mrrt.schedule(world);
        }
        world.init_resource::<leaf_graph::LeafGraph>();
        world.init_resource::<planting::Plantings>();
        world.init_resource::<joining::Growing>();
        world.init_resource::<joining::Straight>();
        world.init_resource::<joining::Next>();
        world.init_resource::<rounds::Rounds>();
        let mut schedule = empty_schedule();
        schedule.add_systems((
            (sampling::reset_candidates, sampling::sample_configurations).chain().in_set(SearchSet::Sample),
            (
                joining::grow_joins,
                planting::rest,
                selection::gather_weights,
                aiming::measure_leaves,
                aiming::choose_leaves,
                selection::select_nodes,
                planting::choose_plantings,
                selection::select_transitions,
            )
                .chain()
                .in_set(SearchSet::Select),
            (rendezvous::draw_leaves, planting::stay_near).chain().in_set(SearchSet::Rendezvous),
            (projection::project_waypoints, planting::leave_out_first_legs).chain().in_set(SearchSet::Project),
            (waypoints::check_waypoints, steering::steer_legs, planting::drop_what_was_cut_short)
                .chain()
                .in_set(SearchSet::Steer),
            (validation::certify_legs, planting::keep_whole_plantings).chain().in_set(SearchSet::Validate),
            (commit::commit_extensions, goals::draw_more_goals).chain().in_set(SearchSet::Commit),
            rounds::join_in_rounds.in_set(SearchSet::Connect),
            (conclusion::conclude, conclusion::report_progress, feedback::report_feedback, conclusion::report_solution)
                .chain()
                .in_set(SearchSet::Conclude),
        ));
        schedule
    }
}

/// Whether every transition is a loop, so that all sequences are empty and there is nothing to plant: plain motion planning.
fn stays_on_its_leaf(world: &World) -> bool {
    let graph = &world.resource::<PlanningModel>().graph;
    !graph.lazy && graph.transitions.iter().all(|transition| transition.kind == TransitionKind::Loop)
}
