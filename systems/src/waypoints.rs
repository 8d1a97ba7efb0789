//! The exact verdict of waypoints, in front of Steer: a waypoint in collision is refused before motions lead to it.
//!
//! All pairs are asked, also those that a leg keeps in constant relative pose: the one test that holds for the leaf. A
//! motion on implicit rows costs many projections, the verdict less than a few of them.

use crate::events::StopSignal;
use crate::model::PlanningModel;
use crate::parallel::each;
use crate::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Local, Query, Res, ResMut};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena, PlannedLeg};
use foliate_components::graph::TransitionKind;
use foliate_components::outcome::Rejection;
use foliate_kernels::collision::CollisionScratch;

/// Refuses candidates that have a waypoint in collision; marks the others.
pub fn check_waypoints(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    mut arena: ResMut<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
    buffers: Local<'_, ScratchPool<(CollisionScratch, Vec<Pose>)>>,
) {
    let mut pool: Vec<_> = candidates.iter_mut().collect();
    pool.sort_unstable_by_key(|c| c.index);
    let mut alive: Vec<_> = pool.iter_mut().zip(&mut arena.legs).filter(|(c, _)| c.is_alive()).collect();
    let buffers = &*buffers;
    each(
        &mut alive,
        || buffers.borrow(),
        |scratch, (candidate, legs)| {
            let (collision, X_WJ) = &mut **scratch;
            collision.set_level(settings.level);
            X_WJ.resize(model.kinematics.bodies(), Pose::identity());
            if stop.is_raised() {
                candidate.reject(Rejection::Stopped);
            }
            candidate.waypoints_are_free =
                candidate.is_alive() && waypoints_are_free(&model, &settings, candidate, legs, (collision, X_WJ));
            if !candidate.waypoints_are_free {
                legs.clear();
            }
        },
    );
}

/// Whether no waypoint is in collision; rejects the candidate that has one. The end of a loop is none: of a motion
/// towards it what comes before a collision is kept.
pub(crate) fn waypoints_are_free(
    model: &PlanningModel,
    settings: &SearchSettings,
    candidate: &mut Candidate,
    legs: &[PlannedLeg],
    (collision, X_WJ): (&mut CollisionScratch, &mut [Pose]),
) -> bool {
    let size = model.problem.robot.space.size();
    let Some(transition) = candidate.transition else { return false };
    if model.graph.transition(transition).kind == TransitionKind::Loop {
        return true;
    }
    for (index, leg) in legs.iter().enumerate() {
        // A leg that steering cut short ends at no waypoint; where it starts says as much about its leaf.
        let ends_at_waypoint = candidate.is_alive() || index + 1 < legs.len();
        let at = if ends_at_waypoint { leg.knots.len() - size } else { 0 };
        model.kinematics.forward(&leg.knots[at..at + size], X_WJ);
        let contact = model.first_collision_along(transition, X_WJ, settings.clearance_guard, collision);
        if let Some(contact) = contact {
            candidate.reject(Rejection::WaypointBlocked(leg.leg as u8));
            candidate.blocked_by = Some(model.pair_shapes(contact.pair));
            return false;
        }
    }
    true
}
