//! Which candidates are lazy extensions: waypoints and the short motions between them, without the long motion that leads to
//! the first waypoint. The short motions become an unvalidated edge, which is certified when a sequence needs it.
//!
//! **Which transition is tried on a leaf** is a bandit's choice. Its choices are the transitions that leave the leaf, crossed ones once for each
//! leaf that they aim at. One is drawn in proportion to its weight, and its weight falls as 1 / ((1 + successes) (1 + tries / 8)): what
//! has been found need not be found again, and what fails makes room for what was tried less.
//!
//! **No transition of a leaf is starved**, outside of corridors and as far as probabilities go: its weight depends on its own counts, is never zero, and is changed
//! by preferences for what leads ahead by bounded factors alone. So a transition that is not tried any more keeps a share of at least some
//! c > 0 of its leaf, and each candidate that starts there tries it with that probability. Candidates start on every leaf without end: at least a tenth of
//! them draw a side, a state and a leaf evenly, and leaves grow by no more than a number in each step. So the conditional probabilities, given all that went
//! before, sum up as those of 1 / step, to infinity (Lévy's form of the lemma of Borel and Cantelli). This does not hold for each leaf that a crossed transition may aim at: there
//! are as many as there are leaves. Besides, every 64th candidate follows the rules of `mrrt`, which know no history.
//!
//! Releases onto new leaves are one choice however many leaves there are. Its weight has a floor that rises while nothing comes
//! nearer: where what is known leads nowhere, new leaves are missing.

use crate::sequence::candidate_roles::CandidateRole;
use bevy_ecs::prelude::{Query, Res, ResMut, Resource};
use foliate_components::candidate::{Candidate, CandidateArena, CommitAs};
use foliate_components::graph::leaf::LeafId;
use foliate_components::graph::{Leg, Transition, TransitionId, TransitionKind};
use foliate_components::outcome::Rejection;
use foliate_systems::exploration::entities::TransitionWeights;
use foliate_systems::exploration::explored::Explored;
use foliate_systems::exploration::roadmap_query::RoadmapQuery;
use foliate_systems::heuristic::blocking::MoveOrder;
use foliate_systems::heuristic::leaf_heuristic::LeafHeuristic;
use foliate_systems::planning_model::model::PlanningModel;
use foliate_systems::runtime::random::{Purpose, draw, stream};
use foliate_systems::schedule::StepCounter;
use foliate_systems::settings::SearchSettings;
use rand::RngExt;
use std::collections::BTreeMap;

/// A transition loses half of its weight on a leaf in so many tries.
const PATIENCE: f64 = 8.0;

/// What is left at least of the weight of a transition that finds a new leaf each time, as long as there is progress.
const FLOOR: f64 = 0.15;

/// So many steps without a leaf that is nearer to another side say nothing; in so many more half of the weight that it lost
/// comes back.
const EARLY: u64 = 16;
const LATE: f64 = 64.0;

/// How often at least such a transition is extended lazily when it is drawn.
const FLOOR_KEPT: f64 = 0.75;

/// With so many successes a transition is extended lazily half as often on a leaf as it is drawn there.
const ENOUGH: f64 = 3.0;

/// The share of the way from the near node to a random configuration at which the search for a waypoint starts is a number drawn
/// evenly from [0, 1] to this power. Near waypoints are joined by short motions; far ones are found where there are no near ones.
const AWAY: f64 = 0.7;

/// What is tried from a leaf: a transition, and where it is crossed the leaf that it aims at.
pub(crate) type Attempt = (LeafId, TransitionId, Option<LeafId>);

/// What became of the transitions that were tried from each leaf.
#[derive(Clone, Debug, Default, Resource)]
pub struct LazyExtensions {
    counts: BTreeMap<Attempt, Count>,
    /// The fewest changes of grasp that the likeliest leaf of a side has been from another side, and the step in which that was found.
    nearest: Option<(u16, u64)>,
    /// [`Self::floor`] of this step.
    floor: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Count {
    tries: u32,
    succeeded: u32,
}

impl LazyExtensions {
    /// What is left of a transition's weight on a leaf: it falls with every success and, slower, with every try, but never to
    /// zero. One that finds a new leaf each time keeps at least [`FLOOR`]: what its tries have found says little of what the next
    /// one will, and all its leaves share one entry here, where those that are aimed at have one each.
    fn freshness(&self, attempt: Attempt, finds_new_leaves: bool) -> f64 {
        let Count { tries, succeeded } = self.counts.get(&attempt).copied().unwrap_or_default();
        let left = 1.0 / ((1.0 + f64::from(succeeded)) * (1.0 + f64::from(tries) / PATIENCE));
        if finds_new_leaves { left.max(self.floor) } else { left }
    }

    /// Sets the floor of this step from how far the leaf is that is nearest to another side: it rises from [`FLOOR`] towards the
    /// weight of what was never tried while no leaf comes nearer, and falls back when one does.
    fn look_at_progress(&mut self, far: u16, step: u64) {
        if self.nearest.is_none_or(|(nearest, _)| far < nearest) {
            self.nearest = Some((far, step));
        }
        let since = self.nearest.map_or(0, |(_, since)| step - since);
        let late = since.saturating_sub(EARLY) as f64;
        self.floor = FLOOR + (1.0 - FLOOR) * late / (late + LATE);
    }

    /// Takes a success back: the lazy extension leads nowhere.
    pub(crate) fn take_back(&mut self, attempt: Attempt) {
        if let Some(count) = self.counts.get_mut(&attempt) {
            count.succeeded = count.succeeded.saturating_sub(1);
        }
    }

    /// Probability that it is extended lazily once more.
    fn keeping_probability(&self, attempt: Attempt, finds_new_leaves: bool) -> f64 {
        let succeeded = self.counts.get(&attempt).map_or(0, |count| count.succeeded);
        let kept = ENOUGH / (ENOUGH + f64::from(succeeded));
        if finds_new_leaves { kept.max(FLOOR_KEPT) } else { kept }
    }
}

/// Leaves out the candidates that have nothing to do so early.
pub fn rest(step: Res<'_, StepCounter>, arena: Res<'_, CandidateArena>, mut candidates: Query<'_, '_, &mut Candidate>) {
    for mut candidate in candidates.iter_mut().filter(|c| c.is_alive() && c.near.is_none()) {
        if CandidateRole::of(&step, arena.complete.len(), &candidate).rests() {
            candidate.reject(Rejection::LeftOut);
        }
    }
}

/// Leaves out all candidates.
pub fn rest_all(mut candidates: Query<'_, '_, &mut Candidate>) {
    candidates.iter_mut().for_each(|mut candidate| candidate.reject(Rejection::LeftOut));
}

/// Draws for the candidates that have none a transition that leads to another state, by weight, by where it leads to, and by
/// what came of it so far; where its first leg may be left out, it is.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn choose_lazy_extensions(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_, '_>,
    arena: Res<'_, CandidateArena>,
    weights: Res<'_, TransitionWeights>,
    mut lazy_extensions: ResMut<'_, LazyExtensions>,
    mut heuristic: ResMut<'_, LeafHeuristic>,
    mut order: ResMut<'_, MoveOrder>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let far = explored.roadmap().sides().filter_map(|side| Some(heuristic.heaviest(side)?.0)).min();
    lazy_extensions.look_at_progress(far.unwrap_or(u16::MAX), step.step);
    for mut candidate in candidates.iter_mut().filter(|c| c.is_alive()) {
        let Some(near) = candidate.near else { continue };
        if let Some(chosen) = candidate.transition {
            candidate.commit_as = commit_as(model.graph.transition(chosen));
            continue;
        }
        if CandidateRole::of(&step, arena.complete.len(), &candidate).is_ordinary() {
            continue;
        }
        let mut rng = stream(settings.seed, Purpose::SELECT, step.step, candidate.index | 1 << 31);
        let row = explored.roadmap().node(near);
        let from = explored.leaves.leaf(row.leaf);
        let target_leaf = candidate.target_leaf.map(|target_leaf| explored.leaves.leaf(target_leaf));
        let leads_on = |&(_, transition): &(TransitionId, &Transition)| transition.kind != TransitionKind::Loop;
        let leaving = || model.graph.leaving(row.state).filter(leads_on);
        let weigh = |(id, transition): (TransitionId, &Transition)| {
            let drawn = candidate.target_leaf.filter(|_| transition.kind == TransitionKind::Crossed);
            let freshness = lazy_extensions.freshness((row.leaf, id, drawn), finds_new_leaves(transition));
            (id, weights.0[id.at()] * freshness)
        };
        let mut choices: Vec<_> = leaving().map(weigh).collect();
        if let Some(target_leaf) = target_leaf {
            let preferences =
                heuristic.preferences(&model.graph, from, target_leaf, leaving().map(|(_, transition)| transition));
            choices.iter_mut().zip(preferences).for_each(|((_, weight), preference)| *weight *= preference);
            let ordered = order.preferences(&model, &explored.leaves, (from, target_leaf), leaving());
            let ordered = ordered.into_iter().flatten();
            choices.iter_mut().zip(ordered).for_each(|((_, weight), preference)| *weight *= preference);
        }
        heuristic.stay_in_corridor(&model.graph, from, &mut choices);
        // Where there are only loops, the ordinary rule draws one.
        if let Some(id) = draw(&choices, rng.random()) {
            let transition = model.graph.transition(id);
            let drawn = candidate.target_leaf.filter(|_| transition.kind == TransitionKind::Crossed);
            heuristic.count_try(row.leaf);
            if rng.random::<f64>()
                >= lazy_extensions.keeping_probability((row.leaf, id, drawn), finds_new_leaves(transition))
            {
                candidate.reject(Rejection::LeftOut);
                continue;
            }
            candidate.transition = Some(id);
            candidate.commit_as = commit_as(transition);
        }
    }
}

/// Whether a transition reaches another leaf of its target each time.
fn finds_new_leaves(transition: &Transition) -> bool {
    transition.kind == TransitionKind::Regular && !transition.adds.is_empty()
}

fn commit_as(transition: &Transition) -> CommitAs {
    if starts_far(transition) { CommitAs::DetachedTrees } else { CommitAs::Extension }
}

/// Whether the first leg of a transition is a long motion on the leaf that it leaves.
fn starts_far(transition: &Transition) -> bool {
    let on_own_leaf = |leg: &Leg| leg.state == transition.from && !leg.short;
    transition.kind != TransitionKind::Loop && transition.legs.first().is_some_and(on_own_leaf)
}

/// Moves the random configurations of lazy extensions towards the near node, by a random share.
pub fn stay_near(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    roadmap: RoadmapQuery<'_, '_>,
    mut arena: ResMut<'_, CandidateArena>,
    candidates: Query<'_, '_, &Candidate>,
) {
    let roadmap = roadmap.view();
    let size = arena.configuration_size();
    for candidate in candidates.iter().filter(|c| c.is_alive() && c.commit_as == CommitAs::DetachedTrees) {
        let Some(near) = candidate.near else { continue };
        let mut rng = stream(settings.seed, Purpose::LAZY_EXTENSION, step.step, candidate.index);
        let away = rng.random::<f64>().powf(AWAY);
        let q = &mut arena.random[candidate.index as usize * size..][..size];
        let far = q.to_vec();
        model.problem.robot.space.interpolate(roadmap.configuration(near), &far, away, q);
        model.lock(q);
    }
}

/// Remembers what came of each transition on its leaf.
pub fn count_outcomes(
    roadmap: RoadmapQuery<'_, '_>,
    mut lazy_extensions: ResMut<'_, LazyExtensions>,
    arena: Res<'_, CandidateArena>,
    candidates: Query<'_, '_, &Candidate>,
) {
    let roadmap = roadmap.view();
    for candidate in &candidates {
        let (Some(near), Some(transition)) = (candidate.near, candidate.transition) else { continue };
        let attempt = (roadmap.node(near).leaf, transition, candidate.drawn);
        let count = lazy_extensions.counts.entry(attempt).or_default();
        count.tries += 1;
        count.succeeded += u32::from(!arena.legs[candidate.index as usize].is_empty());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a leaf with `others` crossed arms that all fail: how many of `draws` tries the release onto a new leaf gets, which
    /// always finds one, while no leaf comes nearer, or one in every step.
    fn releases(others: u32, draws: u32, comes_nearer: bool) -> u32 {
        let mut bandit = LazyExtensions::default();
        let arm = |number: u32| (LeafId(0), TransitionId(number), (number > 0).then_some(LeafId(number)));
        let mut rng = stream(1, Purpose::SELECT, 0, 0);
        let mut drawn = 0;
        for step in 0..draws {
            let far = if comes_nearer { (draws - step) as u16 } else { 1 };
            bandit.look_at_progress(far, u64::from(step));
            let choices: Vec<_> =
                (0..=others).map(|number| (number, bandit.freshness(arm(number), number == 0))).collect();
            let number = draw(&choices, rng.random()).unwrap_or(0);
            let count = bandit.counts.entry(arm(number)).or_default();
            count.tries += 1;
            count.succeeded += u32::from(number == 0);
            drawn += u32::from(number == 0);
        }
        drawn
    }

    #[test]
    fn new_leaves_are_looked_for_where_nothing_comes_nearer() {
        let (early, late) = (releases(8, 2000, true), releases(8, 2000, false));
        assert!(late > 2 * early, "{early} with progress, {late} without");
    }

    #[test]
    fn no_arm_is_starved() {
        // One that has succeeded often and one that has failed often are both drawn again.
        let mut bandit = LazyExtensions::default();
        let arm = |number: u32| (LeafId(0), TransitionId(number), None);
        for (number, count) in [(0, Count { tries: 90, succeeded: 90 }), (1, Count { tries: 900, succeeded: 0 })] {
            bandit.counts.insert(arm(number), count);
        }
        let mut rng = stream(2, Purpose::SELECT, 0, 0);
        let mut tries = [0; 4];
        for _ in 0..20_000 {
            let choices: Vec<_> = (0..4).map(|number| (number, bandit.freshness(arm(number), false))).collect();
            let number = draw(&choices, rng.random()).unwrap_or(0);
            bandit.counts.entry(arm(number)).or_default().tries += 1;
            tries[number as usize] += 1;
        }
        assert!(tries.iter().all(|&tries| tries > 20), "{tries:?}");
    }
}
