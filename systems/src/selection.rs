//! Set Select: the node to extend, then a transition by weight (P1 §III-A steps 2-4, P0 Alg. 1 lines 5-6).

use crate::aiming::Aims;
use crate::model::PlanningModel;
use crate::random::{Purpose, stream};
use crate::schedule::StepCounter;
use crate::settings::{SearchSettings, Selection};
use bevy_ecs::prelude::{Component, Query, Res, ResMut, Resource};
use foliate_components::candidate::{Candidate, CandidateArena};
use foliate_components::graph::{StateId, Transition, TransitionId};
use foliate_components::leaf::{LeafId, LeafIndex};
use foliate_components::outcome::Rejection;
use foliate_components::roadmap::{ComponentId, NodeId, Roadmap};
use rand::RngExt;
use rand::seq::IndexedRandom;
use rayon::prelude::*;

/// The weight by which a transition is drawn; on the transition's entity, so that a host's system may change it.
#[derive(Clone, Copy, Debug, PartialEq, Component)]
pub struct Weight(pub f64);

/// Weights by transition, gathered at the start of every step.
#[derive(Clone, Debug, Default, Resource)]
pub struct TransitionWeights(pub Vec<f64>);

/// Which leaves each tree has reached, in order of first visit; kept by the commit.
#[derive(Clone, Debug, Default, Resource)]
pub struct ReachedLeaves {
    /// By tree: its leaves.
    pub by_component: Vec<Vec<LeafId>>,
}

/// Copies the weights from the transitions' entities into a slice.
pub fn gather_weights(
    transitions: Query<'_, '_, (&TransitionId, &Weight)>,
    mut weights: ResMut<'_, TransitionWeights>,
) {
    weights.0.clear();
    for (id, weight) in &transitions {
        if weights.0.len() <= id.at() {
            weights.0.resize(id.at() + 1, 0.0);
        }
        weights.0[id.at()] = if weight.0.is_finite() { weight.0.max(0.0) } else { 0.0 };
    }
}

/// Chooses for every candidate a node as [`SearchSettings::selection`] says.
pub fn select_nodes(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    roadmap: Res<'_, Roadmap>,
    leaves: Res<'_, ReachedLeaves>,
    index: Res<'_, LeafIndex>,
    aims: Res<'_, Aims>,
    arena: Res<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let trees = live_trees(&roadmap);
    let mut pool: Vec<_> = candidates.iter_mut().collect();
    pool.par_iter_mut().filter(|c| c.is_alive()).for_each(|candidate| {
        let mut rng = stream(settings.seed, Purpose::Select, step.step, candidate.index);
        let Some(&tree) = trees.choose(&mut rng) else { return candidate.reject(Rejection::NoNode) };
        let q = arena.random_of(candidate.index);
        let chosen = match settings.selection {
            Selection::Nearest => {
                let all = (0..roadmap.nodes().len() as u32).map(NodeId);
                model.nearest(&roadmap, q, all, &model.weights)
            }
            Selection::StateFirst => {
                let states = states_of(&roadmap, &leaves, tree);
                states.choose(&mut rng).and_then(|&state| {
                    let nodes = nodes_in_state(&roadmap, &leaves, tree, state);
                    model.nearest(&roadmap, q, nodes, &model.weights)
                })
            }
            Selection::LeafFirst => {
                let leaf = leaf_of(&reached_by(&roadmap, &leaves, tree), &mut rng);
                leaf.and_then(|leaf| nearest_on(&model, &roadmap, leaf, tree, q))
            }
            Selection::Guided => {
                let reached = reached_by(&roadmap, &leaves, tree);
                let leaf = if rng.random::<f64>() < settings.guided_probability {
                    let leaf = aims.leaf(&roadmap, &reached, tree, &mut rng);
                    candidate.aim =
                        leaf.and_then(|leaf| aims.aim(&model, &roadmap, &index, &leaves, (leaf, tree), &mut rng));
                    leaf
                } else {
                    leaf_of(&reached, &mut rng)
                };
                leaf.and_then(|leaf| nearest_on(&model, &roadmap, leaf, tree, q))
            }
        };
        match chosen {
            Some(node) => {
                candidate.near = Some(node);
                candidate.component = Some(roadmap.component_of(node));
            }
            None => candidate.reject(Rejection::NoNode),
        }
    });
}

/// Draws for every candidate a transition that leaves its node's state, in proportion to the weights.
pub fn select_transitions(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    roadmap: Res<'_, Roadmap>,
    weights: Res<'_, TransitionWeights>,
    leaves: Res<'_, LeafIndex>,
    mut aims: ResMut<'_, Aims>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    for mut candidate in candidates.iter_mut().filter(|c| c.is_alive()) {
        let Some(near) = candidate.near else {
            candidate.reject(Rejection::NoNode);
            continue;
        };
        let mut rng = stream(settings.seed, Purpose::Select, step.step, candidate.index | 1 << 31);
        let row = roadmap.node(near);
        if let Some(tries) = aims.tries.get_mut(row.leaf.at()) {
            *tries += 1;
        }
        let from = leaves.leaf(row.leaf);
        let aim = candidate.aim.map(|aim| leaves.leaf(aim));
        let weigh = |(id, transition): (TransitionId, &Transition)| {
            let preference =
                aim.map_or(1.0, |aim| aims.preference(aims.distance().after(&model.graph, from, transition, aim)));
            (id, weights.0[id.at()] * preference)
        };
        let choices: Vec<_> = model.graph.leaving(row.state).map(weigh).collect();
        let mut left = rng.random::<f64>() * choices.iter().map(|&(_, w)| w).sum::<f64>();
        let drawn = choices.iter().find(|&&(_, w)| {
            left -= w;
            left < 0.0
        });
        match drawn {
            Some(&(transition, _)) => candidate.transition = Some(transition),
            None => candidate.reject(Rejection::NoTransition),
        }
    }
}

/// The trees that have not been absorbed by another, by id.
fn live_trees(roadmap: &Roadmap) -> Vec<ComponentId> {
    (0..roadmap.trees() as u32).map(ComponentId).filter(|&c| roadmap.component(c) == c).collect()
}

/// All trees that have been joined into `tree`.
fn members(roadmap: &Roadmap, tree: ComponentId) -> impl Iterator<Item = ComponentId> {
    (0..roadmap.trees() as u32).map(ComponentId).filter(move |&c| roadmap.component(c) == tree)
}

/// The leaves that a tree has reached, sorted by state.
fn reached_by(roadmap: &Roadmap, leaves: &ReachedLeaves, tree: ComponentId) -> Vec<(StateId, LeafId)> {
    let mut reached: Vec<(StateId, LeafId)> = members(roadmap, tree)
        .flat_map(|c| &leaves.by_component[c.at()])
        .filter_map(|&leaf| roadmap.nodes_on(leaf).first().map(|&n| (roadmap.node(n).state, leaf)))
        .collect();
    reached.sort_unstable();
    reached.dedup();
    reached
}

/// One of the leaves that a tree has reached: a state uniformly, then one of the leaves reached in it. States with few
/// leaves are often the narrow ones (one leaf holds every solid grasp of an object), so leaves alone would starve them.
fn leaf_of(reached: &[(StateId, LeafId)], rng: &mut impl rand::Rng) -> Option<LeafId> {
    let states: Vec<_> = reached.chunk_by(|a, b| a.0 == b.0).collect();
    states.choose(rng)?.choose(rng).map(|&(_, leaf)| leaf)
}

/// The node of a tree on a leaf that is nearest to q, objects aside.
fn nearest_on(model: &PlanningModel, roadmap: &Roadmap, leaf: LeafId, tree: ComponentId, q: &[f64]) -> Option<NodeId> {
    let here = |n: &NodeId| roadmap.component_of(*n) == tree;
    model.nearest(roadmap, q, roadmap.nodes_on(leaf).iter().copied().filter(here), &model.robot_weights)
}

fn states_of(roadmap: &Roadmap, leaves: &ReachedLeaves, tree: ComponentId) -> Vec<StateId> {
    let mut states: Vec<StateId> = members(roadmap, tree)
        .flat_map(|c| &leaves.by_component[c.at()])
        .filter_map(|&leaf| roadmap.nodes_on(leaf).first().map(|&n| roadmap.node(n).state))
        .collect();
    states.sort_unstable();
    states.dedup();
    states
}

fn nodes_in_state<'a>(
    roadmap: &'a Roadmap,
    leaves: &'a ReachedLeaves,
    tree: ComponentId,
    state: StateId,
) -> impl Iterator<Item = NodeId> + 'a {
    members(roadmap, tree)
        .flat_map(|c| &leaves.by_component[c.at()])
        .flat_map(|&leaf| roadmap.nodes_on(leaf).iter().copied())
        .filter(move |&n| roadmap.node(n).state == state && roadmap.component_of(n) == tree)
}
