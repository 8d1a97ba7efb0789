//! Set Select: the node to extend, then a transition by weight (P1 §III-A steps 2-4, P0 Alg. 1 lines 5-6).

use crate::model::PlanningModel;
use crate::random::{Purpose, stream};
use crate::schedule::StepCounter;
use crate::settings::{SearchSettings, Selection};
use bevy_ecs::prelude::{Component, Query, Res, ResMut, Resource};
use foliate_components::candidate::{Candidate, CandidateArena};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::leaf::LeafId;
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
            Selection::LeafFirst => leaf_of(&roadmap, &leaves, tree, &mut rng).and_then(|leaf| {
                let here = |n: &NodeId| roadmap.component_of(*n) == tree;
                let nodes = roadmap.nodes_on(leaf).iter().copied().filter(here);
                model.nearest(&roadmap, q, nodes, &model.robot_weights)
            }),
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
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    for mut candidate in candidates.iter_mut().filter(|c| c.is_alive()) {
        let Some(near) = candidate.near else {
            candidate.reject(Rejection::NoNode);
            continue;
        };
        let mut rng = stream(settings.seed, Purpose::Select, step.step, candidate.index | 1 << 31);
        let state = roadmap.node(near).state;
        let total: f64 = model.graph.leaving(state).map(|(t, _)| weights.0[t.at()]).sum();
        let mut left = rng.random::<f64>() * total;
        let drawn = model.graph.leaving(state).find(|(t, _)| {
            left -= weights.0[t.at()];
            left < 0.0
        });
        match drawn {
            Some((transition, _)) => candidate.transition = Some(transition),
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

/// One of the leaves that a tree has reached: a state uniformly, then one of the leaves reached in it. States with few
/// leaves are often the narrow ones (one leaf holds every solid grasp of an object), so leaves alone would starve them.
fn leaf_of(roadmap: &Roadmap, leaves: &ReachedLeaves, tree: ComponentId, rng: &mut impl rand::Rng) -> Option<LeafId> {
    let mut reached: Vec<(StateId, LeafId)> = members(roadmap, tree)
        .flat_map(|c| &leaves.by_component[c.at()])
        .filter_map(|&leaf| roadmap.nodes_on(leaf).first().map(|&n| (roadmap.node(n).state, leaf)))
        .collect();
    reached.sort_unstable();
    reached.dedup();
    let states: Vec<_> = reached.chunk_by(|a, b| a.0 == b.0).collect();
    states.choose(rng)?.choose(rng).map(|&(_, leaf)| leaf)
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
