//! What sets Project and Steer do for candidates that are committed as [`CommitAs::DetachedTrees`]: their first legs are left
//! out, and only whole ones are kept.

use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::each;
use crate::runtime::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Local, Query, Res, ResMut};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena, CommitAs, PlannedLeg};
use foliate_components::outcome::Rejection;
use foliate_kernels::collision::{CollisionScratch, PairId};

/// Set Project, after the projection: leaves out all of a first leg but its end. Rejects the candidate where that end breaks a
/// margin of its own state.
pub fn leave_out_first_legs(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    mut arena: ResMut<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
    buffers: Local<'_, ScratchPool<(CollisionScratch, Vec<Pose>)>>,
) {
    let buffers = &*buffers;
    let size = arena.configuration_size();
    let mut succeeded = Vec::new();
    let pool: Vec<_> =
        candidates.iter_mut().filter(|c| c.is_alive() && c.commit_as == CommitAs::DetachedTrees).collect();
    let mut legs = arena.legs.iter_mut().enumerate();
    for candidate in pool {
        let own = legs.find(|&(index, _)| index == candidate.index as usize);
        let Some(first) = own.and_then(|(_, legs)| legs.first_mut()) else { continue };
        let before = first.knots.len() - size;
        first.knots.drain(..before);
        succeeded.push((candidate, &*first));
    }
    if model.problem.margins.is_empty() {
        return;
    }
    each(
        &mut succeeded,
        || buffers.borrow(),
        |scratch, (candidate, first)| {
            let (collision, X_WJ) = &mut **scratch;
            X_WJ.resize(model.kinematics.bodies(), Pose::identity());
            if let Some(pair) = breaks_margin(&model, &settings, first, (collision, X_WJ)) {
                candidate.reject(Rejection::WaypointBlocked(0));
                candidate.blocked_by = Some(model.pair_shapes(pair));
                candidate.blocked_at = settings.log.then(|| first.knots.as_slice().into());
            }
        },
    );
}

/// The pair that is closer than the margins of a leg's own state allow, where the leg ends. Along a transition the margins of
/// what it brings together are lifted, but here other motions may start.
fn breaks_margin(
    model: &PlanningModel,
    settings: &SearchSettings,
    leg: &PlannedLeg,
    (collision, X_WJ): (&mut CollisionScratch, &mut [Pose]),
) -> Option<PairId> {
    model.kinematics.forward(&leg.knots, X_WJ);
    model.first_collision(leg.state, X_WJ, settings.clearance_guard, collision).map(|contact| contact.pair)
}

/// Set Steer, after the steering: drops what was cut short, since only the whole joins two leaves.
pub fn drop_cut_short(mut arena: ResMut<'_, CandidateArena>, candidates: Query<'_, '_, &Candidate>) {
    for candidate in candidates.iter().filter(|c| c.commit_as == CommitAs::DetachedTrees && !c.is_alive()) {
        arena.legs[candidate.index as usize].clear();
    }
}
