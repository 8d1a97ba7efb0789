//! Candidates that are planted: waypoints and the short motions between them, without the long motion that leads there.

use crate::guidance::aiming::Aims;
use crate::model::PlanningModel;
use crate::random::{Purpose, draw, stream};
use crate::schedule::StepCounter;
use crate::selection::{Explored, TransitionWeights};
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res, ResMut, Resource};
use foliate_components::Pose;
use foliate_components::candidate::{Candidate, CandidateArena};
use foliate_components::graph::{Transition, TransitionId, TransitionKind};
use foliate_components::leaf::LeafId;
use foliate_components::outcome::Rejection;
use foliate_kernels::collision::CollisionScratch;
use rand::RngExt;
use std::collections::BTreeMap;

/// Every so many candidates one is an extension as `mrrt` makes them, so that nothing is given up for good.
const ORDINARY_EVERY: u32 = 8;

/// A transition loses half of its weight on a leaf in so many tries.
const PATIENCE: f64 = 8.0;

/// What became of the transitions that were tried from each leaf.
#[derive(Clone, Debug, Default, Resource)]
pub struct Plantings {
    /// Tries and successes.
    counts: BTreeMap<(LeafId, TransitionId), (u32, u32)>,
}

impl Plantings {
    /// What is left of a transition's weight on a leaf: what was planted there already is planted less, and what fails again
    /// and again is tried less.
    fn freshness(&self, leaf: LeafId, transition: TransitionId) -> f64 {
        let (tries, planted) = self.counts.get(&(leaf, transition)).copied().unwrap_or_default();
        1.0 / ((1.0 + f64::from(planted)) * (1.0 + f64::from(tries) / PATIENCE))
    }
}

/// Whether a candidate is left to the rules of `mrrt`.
fn is_ordinary(candidate: &Candidate) -> bool {
    candidate.index % ORDINARY_EVERY == ORDINARY_EVERY - 1
}

/// Whether the first leg of a transition is a long motion on the leaf that it leaves.
fn starts_far(transition: &Transition) -> bool {
    let on_own_leaf = |leg: &foliate_components::graph::Leg| leg.state == transition.from && !leg.short;
    transition.kind != TransitionKind::Loop && transition.legs.first().is_some_and(on_own_leaf)
}

/// Draws for the candidates that have none a transition that leads to another state, by weight, by where it leads to, and by
/// what came of it so far; where its first leg may be left out, it is.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn choose_plantings(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_>,
    weights: Res<'_, TransitionWeights>,
    plantings: Res<'_, Plantings>,
    mut aims: ResMut<'_, Aims>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let under_way = |c: &Candidate| c.is_alive() && c.transition.is_none() && !is_ordinary(c);
    for mut candidate in candidates.iter_mut().filter(|c| under_way(c)) {
        let Some(near) = candidate.near else { continue };
        let mut rng = stream(settings.seed, Purpose::Select, step.step, candidate.index | 1 << 31);
        let row = explored.roadmap.node(near);
        let from = explored.leaves.leaf(row.leaf);
        let aim = candidate.aim.map(|aim| explored.leaves.leaf(aim));
        let weigh = |(id, transition): (TransitionId, &Transition)| {
            let preference = aim.map_or(1.0, |aim| aims.preference(&model.graph, from, transition, aim));
            (id, weights.0[id.at()] * preference * plantings.freshness(row.leaf, id))
        };
        let leads_on = |&(_, transition): &(TransitionId, &Transition)| transition.kind != TransitionKind::Loop;
        let choices: Vec<_> = model.graph.leaving(row.state).filter(leads_on).map(weigh).collect();
        // Where there are only loops, the ordinary rule draws one.
        if let Some(id) = draw(&choices, rng.random()) {
            candidate.transition = Some(id);
            candidate.plants = starts_far(model.graph.transition(id));
            aims.count_try(row.leaf);
        }
    }
}

/// Leaves out the first legs of what is to be planted: only where they end is kept, and only where that keeps the margins of
/// its own state.
pub fn leave_out_first_legs(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    mut arena: ResMut<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let size = arena.configuration_size();
    for mut candidate in candidates.iter_mut().filter(|c| c.is_alive() && c.plants) {
        let Some(first) = arena.legs[candidate.index as usize].first_mut() else { continue };
        let before = first.knots.len() - size;
        first.knots.drain(..before);
        if model.problem.margins.is_empty() {
            continue;
        }
        let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
        model.kinematics.forward(&first.knots, &mut X_WJ);
        let mut scratch = CollisionScratch::new();
        if let Some(contact) = model.first_collision(first.state, &X_WJ, settings.clearance_guard, &mut scratch) {
            candidate.reject(Rejection::WaypointBlocked(0));
            candidate.blocked_by = Some(model.pair_shapes(contact.pair));
        }
    }
}

/// Drops what steering cut short of what is to be planted: nothing but the whole joins two leaves.
pub fn drop_what_was_cut_short(mut arena: ResMut<'_, CandidateArena>, candidates: Query<'_, '_, &Candidate>) {
    for candidate in candidates.iter().filter(|c| c.plants && !c.is_alive()) {
        arena.legs[candidate.index as usize].clear();
    }
}

/// Drops what is not certified to its end of what is to be planted, and remembers what came of each transition.
pub fn keep_whole_plantings(
    roadmap: Res<'_, foliate_components::roadmap::Roadmap>,
    mut plantings: ResMut<'_, Plantings>,
    mut arena: ResMut<'_, CandidateArena>,
    candidates: Query<'_, '_, &Candidate>,
) {
    let CandidateArena { legs, complete, .. } = &mut *arena;
    for candidate in &candidates {
        let (Some(near), Some(transition)) = (candidate.near, candidate.transition) else { continue };
        let index = candidate.index as usize;
        if candidate.plants && !complete[index] {
            legs[index].clear();
        }
        let counts = plantings.counts.entry((roadmap.node(near).leaf, transition)).or_default();
        counts.0 += 1;
        counts.1 += u32::from(!legs[index].is_empty());
    }
}
