//! Set Select: the node to extend, then a transition by weight (P1 §III-A steps 2-4, P0 Alg. 1 lines 5-6).

use crate::exploration::entities::{TransitionWeights, Weight};
use crate::exploration::explored::Explored;
use crate::exploration::neighbours::index::Neighbours;
use crate::exploration::neighbours::nearest_of_each::{Question, Region};
pub use crate::exploration::reached_leaves::ReachedLeaves;
use crate::heuristic::leaf_heuristic::LeafHeuristic;
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::LEAST_SHARED;
use crate::runtime::random::{Purpose, draw, stream};
use crate::schedule::StepCounter;
use crate::settings::{SearchSettings, Selection};
use bevy_ecs::prelude::{Query, Res, ResMut};
use foliate_components::candidate::{Candidate, CandidateArena};
use foliate_components::graph::{TransitionId, TransitionKind};
use foliate_components::outcome::Rejection;
use foliate_components::roadmap::TreeId;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rayon::prelude::*;

/// Copies the weights from the transitions' entities into a slice, those of loops as the settings want them.
pub fn gather_weights(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    transitions: Query<'_, '_, (&TransitionId, &Weight)>,
    mut weights: ResMut<'_, TransitionWeights>,
) {
    weights.0.clear();
    for (id, weight) in &transitions {
        if weights.0.len() <= id.at() {
            weights.0.resize(id.at() + 1, 0.0);
        }
        let is_loop = model.graph.transition(*id).kind == TransitionKind::Loop;
        let weight = if is_loop { weight.0 * settings.loop_weight } else { weight.0 };
        weights.0[id.at()] = if weight.is_finite() { weight.max(0.0) } else { 0.0 };
    }
}

/// Chooses for every candidate that has none a node: the nearest on its leaf where one is chosen already, else as
/// [`SearchSettings::selection`] says.
pub fn select_nodes(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_, '_>,
    neighbours: Res<'_, Neighbours>,
    arena: Res<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let (reached, roadmap) = (&*explored.reached, explored.roadmap());
    let trees: Vec<TreeId> = roadmap.sides().collect();
    let region_of = |candidate: &Candidate| {
        if let (Some(leaf), Some(tree)) = (candidate.leaf, candidate.tree) {
            return Some((Region::Leaf(leaf), Some(tree)));
        }
        let mut rng = stream(settings.seed, Purpose::SELECT, step.step, candidate.index);
        match settings.selection {
            Selection::Nearest => Some((Region::Roadmap, None)),
            Selection::StateFirst => {
                let &tree = trees.choose(&mut rng)?;
                Some((Region::State(reached.of_tree(tree).choose(&mut rng)?.state), Some(tree)))
            }
            Selection::LeafFirst | Selection::Guided => {
                let &tree = trees.choose(&mut rng)?;
                // States with few leaves are often the narrow ones (one leaf holds every solid grasp of an object), so
                // leaves alone would starve them.
                let &leaf = reached.of_tree(tree).choose(&mut rng)?.leaves.choose(&mut rng)?;
                Some((Region::Leaf(leaf), Some(tree)))
            }
        }
    };
    let mut pool: Vec<_> = candidates.iter_mut().filter(|c| c.is_alive() && c.near.is_none()).collect();
    let mut questions = Vec::with_capacity(pool.len());
    for (asker, candidate) in pool.iter_mut().enumerate() {
        match region_of(candidate) {
            Some((region, tree)) => {
                let q = arena.random_of(candidate.index);
                questions.push(Question { asker, region, tree, q, nearest: None });
            }
            None => candidate.reject(Rejection::NoNode),
        }
    }
    neighbours.answer(&model, roadmap, &mut questions, |born| roadmap.side(born));
    for Question { asker, nearest, .. } in questions {
        match nearest {
            Some(node) => {
                pool[asker].near = Some(node);
                pool[asker].tree = Some(roadmap.side_of(node));
            }
            None => pool[asker].reject(Rejection::NoNode),
        }
    }
}

/// Draws for every candidate that has none a transition that leaves its node's state, in proportion to the weights.
pub fn select_transitions(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_, '_>,
    weights: Res<'_, TransitionWeights>,
    mut heuristic: ResMut<'_, LeafHeuristic>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let mut pool: Vec<_> = candidates.iter_mut().filter(|c| c.is_alive() && c.transition.is_none()).collect();
    pool.par_iter_mut().with_min_len(2 * LEAST_SHARED).for_each(|candidate| {
        let Some(near) = candidate.near else {
            return candidate.reject(Rejection::NoNode);
        };
        let mut rng = stream(settings.seed, Purpose::SELECT, step.step, candidate.index | 1 << 31);
        let row = explored.roadmap().node(near);
        let from = explored.leaves.leaf(row.leaf);
        let target_leaf = candidate.target_leaf.map(|target_leaf| explored.leaves.leaf(target_leaf));
        let leaving = || model.graph.leaving(row.state);
        let mut choices: Vec<_> = leaving().map(|(id, _)| (id, weights.0[id.at()])).collect();
        if let Some(target_leaf) = target_leaf {
            let preferences =
                heuristic.preferences(&model.graph, from, target_leaf, leaving().map(|(_, transition)| transition));
            choices.iter_mut().zip(preferences).for_each(|((_, weight), preference)| *weight *= preference);
        }
        heuristic.stay_in_corridor(&model.graph, from, &mut choices);
        match draw(&choices, rng.random()) {
            Some(transition) => candidate.transition = Some(transition),
            None => candidate.reject(Rejection::NoTransition),
        }
    });
    for near in pool.iter().filter_map(|candidate| candidate.near) {
        heuristic.count_try(explored.roadmap().node(near).leaf);
    }
}
