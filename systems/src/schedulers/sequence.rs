//! `sequence`: sequences of transitions first, long motions last.

use super::Scheduler;
use super::mrrt::Mrrt;
use crate::guidance::aiming;
use crate::in_order::in_order;
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
        world.init_resource::<joining::Tried>();
        world.init_resource::<joining::Next>();
        world.init_resource::<rounds::Rounds>();
        let mut schedule = empty_schedule();
        schedule.add_systems((
            in_order((sampling::reset_candidates, sampling::sample_configurations)).in_set(SearchSet::Sample),
            in_order((
                joining::grow_joins,
                planting::rest,
                selection::gather_weights,
                aiming::measure_leaves,
                aiming::choose_leaves,
                selection::select_nodes,
                planting::choose_plantings,
                selection::select_transitions,
            ))
            .in_set(SearchSet::Select),
            in_order((rendezvous::draw_leaves, planting::stay_near)).in_set(SearchSet::Rendezvous),
            in_order((projection::project_waypoints, planting::leave_out_first_legs)).in_set(SearchSet::Project),
            in_order((waypoints::check_waypoints, steering::steer_legs, planting::drop_what_was_cut_short))
                .in_set(SearchSet::Steer),
            in_order((validation::certify_legs, planting::keep_whole_plantings)).in_set(SearchSet::Validate),
            in_order((commit::commit_extensions, goals::draw_more_goals)).in_set(SearchSet::Commit),
            rounds::join_in_rounds.in_set(SearchSet::Connect),
            in_order((
                conclusion::conclude,
                conclusion::report_progress,
                feedback::report_feedback,
                conclusion::report_solution,
            ))
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
