//! Set Select, the guided half: a leaf that is few grasps from what another tree has reached, and the leaf to aim at.

use crate::guidance::grasp_distance::GraspDistance;
use crate::model::PlanningModel;
use crate::random::{Purpose, draw, stream};
use crate::schedule::StepCounter;
use crate::selection::{Explored, ReachedLeaves};
use crate::settings::{SearchSettings, Selection};
use bevy_ecs::prelude::{Query, Res, ResMut, Resource};
use foliate_components::candidate::Candidate;
use foliate_components::graph::{ConstraintGraph, StateId, Transition};
use foliate_components::leaf::{Leaf, LeafId, LeafIndex};
use foliate_components::roadmap::{ComponentId, Roadmap};
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};
use rayon::prelude::*;

/// A leaf one change of grasp farther is so many times less likely to be chosen.
const FOCUS: f64 = 2.0;
/// A leaf loses half of its weight in so many tries, so that what leads nowhere is left alone.
const LEAF_PATIENCE: f64 = 8.0;
/// Likewise a state.
const STATE_PATIENCE: f64 = 64.0;

/// How far every leaf is from every tree, kept from step to step.
#[derive(Clone, Debug, Default, Resource)]
pub struct Aims {
    distance: GraspDistance,
    /// By tree: how many of the leaves it has reached are known here.
    known: Vec<usize>,
    /// By leaf and tree: changes of grasp to the nearest leaf that the tree has reached.
    nearest: Vec<Vec<u16>>,
    /// By leaf: candidates that started there.
    tries: Vec<u32>,
}

impl Aims {
    /// Changes of grasp from a leaf to the nearest leaf of any tree but `tree`.
    #[must_use]
    pub fn to_others(&self, roadmap: &Roadmap, leaf: LeafId, tree: ComponentId) -> u16 {
        // Trees that were planted reach leaves for their families only.
        let others = (0u32..).map(ComponentId).zip(&self.nearest[leaf.at()]).filter(|&(_, &far)| far < u16::MAX);
        others.filter(|&(c, _)| roadmap.component(c) != tree).map(|(_, &d)| d).min().unwrap_or(0)
    }

    /// Weighs what a tree has reached, `reached` sorted by state: states by their nearest leaves, then the leaves in each.
    fn weigh(&self, roadmap: &Roadmap, reached: &[(StateId, LeafId)], tree: ComponentId) -> WeightedLeaves {
        let weigh_state = |leaves: &[(StateId, LeafId)]| {
            let far = |&(_, leaf): &(StateId, LeafId)| f64::from(self.to_others(roadmap, leaf, tree));
            let tried = |&(_, leaf): &(StateId, LeafId)| f64::from(self.tries[leaf.at()]);
            let near = leaves.iter().map(far).fold(f64::INFINITY, f64::min);
            let tries: f64 = leaves.iter().map(tried).sum();
            let weigh = |leaf| (leaf, FOCUS.powf(-far(leaf)) / (1.0 + tried(leaf) / LEAF_PATIENCE));
            let leaves = leaves.iter().map(weigh).map(|(&(_, leaf), weight)| (leaf, weight)).collect();
            (leaves, FOCUS.powf(-near) / (1.0 + tries / STATE_PATIENCE))
        };
        let (states, weights): (Vec<_>, Vec<_>) = reached.chunk_by(|a, b| a.0 == b.0).map(weigh_state).unzip();
        WeightedLeaves { weights: (0..).zip(weights).collect(), states }
    }

    /// Chooses what to aim at from `leaf`: among the leaves that other trees have reached, near ones first.
    fn aim(
        &self,
        graph: &ConstraintGraph,
        explored: &Explored<'_>,
        (leaf, tree): (LeafId, ComponentId),
        rng: &mut impl Rng,
    ) -> Option<LeafId> {
        let from = explored.leaves.leaf(leaf);
        let all = (0u32..).map(ComponentId).zip(&explored.reached.by_component);
        let others = all.filter(|&(c, _)| explored.families.family(&explored.roadmap, c) != tree);
        let weigh = |&to: &LeafId| {
            let far = self.distance.between(graph, from, explored.leaves.leaf(to));
            (to, FOCUS.powi(-2 * i32::from(far)))
        };
        draw(&others.flat_map(|(_, list)| list).map(weigh).collect::<Vec<_>>(), rng.random())
    }

    /// How much likelier a transition gets by what it leads to.
    pub(crate) fn preference(&self, graph: &ConstraintGraph, from: &Leaf, transition: &Transition, aim: &Leaf) -> f64 {
        FOCUS.powi(-i32::from(self.distance.after(graph, from, transition, aim)))
    }

    /// Remembers that a candidate has started on a leaf.
    pub(crate) fn count_try(&mut self, leaf: LeafId) {
        if let Some(tries) = self.tries.get_mut(leaf.at()) {
            *tries += 1;
        }
    }
}

/// The leaves that a tree has reached, with their weights.
struct WeightedLeaves {
    /// Numbers of states and their weights.
    weights: Vec<(usize, f64)>,
    /// By state: its leaves and their weights.
    states: Vec<Vec<(LeafId, f64)>>,
}

impl WeightedLeaves {
    fn choose(&self, rng: &mut impl Rng) -> Option<LeafId> {
        let state = draw(&self.weights, rng.random())?;
        draw(&self.states[state], rng.random())
    }
}

/// Measures the leaves that the last step has reached, each against all others.
pub fn measure_leaves(
    model: Res<'_, PlanningModel>,
    leaves: Res<'_, LeafIndex>,
    reached: Res<'_, ReachedLeaves>,
    mut aims: ResMut<'_, Aims>,
) {
    let aims = &mut *aims;
    aims.distance.grow(&model.graph);
    let trees = reached.by_component.len();
    aims.known.resize(trees, 0);
    aims.tries.resize(leaves.leaves().len(), 0);
    let before = aims.nearest.len();
    aims.nearest.resize(leaves.leaves().len(), Vec::new());
    aims.nearest.iter_mut().for_each(|row| row.resize(trees, u16::MAX));
    for (tree, list) in reached.by_component.iter().enumerate() {
        let known = std::mem::replace(&mut aims.known[tree], list.len());
        for (number, &to) in list.iter().enumerate() {
            // Old leaves against new ones, and new ones against all.
            let first = if number < known { before } else { 0 };
            for from in first..aims.nearest.len() {
                let far = aims.distance.between(&model.graph, &leaves.leaves()[from], leaves.leaf(to));
                let nearest = &mut aims.nearest[from][tree];
                *nearest = far.min(*nearest);
            }
        }
    }
}

/// Chooses for the guided candidates the leaf to extend and the leaf to aim at.
pub fn choose_leaves(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_>,
    aims: Res<'_, Aims>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    if settings.selection != Selection::Guided {
        return;
    }
    let weigh = |(tree, leaves): (ComponentId, Vec<_>)| (tree, aims.weigh(&explored.roadmap, &leaves, tree));
    let trees: Vec<_> = explored.leaves_by_tree().into_iter().map(weigh).collect();
    let mut pool: Vec<_> = candidates.iter_mut().filter(|c| c.is_alive() && c.near.is_none()).collect();
    pool.par_iter_mut().for_each(|candidate| {
        let mut rng = stream(settings.seed, Purpose::Aim, step.step, candidate.index);
        if rng.random::<f64>() >= settings.guided_probability {
            return;
        }
        let Some((tree, leaves)) = trees.choose(&mut rng) else { return };
        let Some(leaf) = leaves.choose(&mut rng) else { return };
        candidate.component = Some(*tree);
        candidate.leaf = Some(leaf);
        candidate.aim = aims.aim(&model.graph, &explored, (leaf, *tree), &mut rng);
    });
}
