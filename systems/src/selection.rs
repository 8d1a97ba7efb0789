//! Set Select: the node to extend, then a transition by weight (P1 §III-A steps 2-4, P0 Alg. 1 lines 5-6).

use crate::guidance::aiming::Aims;
use crate::model::PlanningModel;
use crate::random::{Purpose, draw, stream};
use crate::schedule::StepCounter;
use crate::settings::{SearchSettings, Selection};
use bevy_ecs::prelude::{Component, Query, Res, ResMut, Resource};
use bevy_ecs::system::SystemParam;
use foliate_components::candidate::{Candidate, CandidateArena};
use foliate_components::graph::{StateId, Transition, TransitionId};
use foliate_components::leaf::{LeafId, LeafIndex};
use foliate_components::outcome::Rejection;
use foliate_components::roadmap::{ComponentId, NodeId, Roadmap};
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};
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

/// On whose behalf each tree grows.
///
/// A tree that was planted hangs together with nothing yet, but it counts to the tree from whose leaf it was planted as if
/// the two were joined: they share what they have reached, and are no rendezvous for one another. Kept by the commit.
#[derive(Clone, Debug, Default, Resource)]
pub struct Families {
    /// By tree as born: the root tree of its family.
    pub(crate) of: Vec<ComponentId>,
}

impl Families {
    /// The root tree on whose behalf a tree was born; the tree itself where it was not planted.
    #[must_use]
    pub fn born_for(&self, tree: ComponentId) -> ComponentId {
        self.of.get(tree.at()).copied().unwrap_or(tree)
    }

    /// The tree that now contains the root tree of a tree's family.
    #[must_use]
    pub fn family(&self, roadmap: &Roadmap, tree: ComponentId) -> ComponentId {
        roadmap.component(self.born_for(tree))
    }

    /// The family of a node.
    #[must_use]
    pub fn family_of(&self, roadmap: &Roadmap, node: NodeId) -> ComponentId {
        self.family(roadmap, roadmap.node(node).component)
    }
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

/// What the trees have reached so far, for systems that choose.
#[derive(SystemParam)]
pub struct Explored<'w> {
    /// Nodes and edges.
    pub roadmap: Res<'w, Roadmap>,
    /// Leaves and parameters.
    pub leaves: Res<'w, LeafIndex>,
    /// Leaves by tree.
    pub reached: Res<'w, ReachedLeaves>,
    /// Trees that count as one.
    pub families: Res<'w, Families>,
}

impl Explored<'_> {
    /// The trees that have not been absorbed by another and were not planted for one, by id.
    pub fn trees(&self) -> impl Iterator<Item = ComponentId> {
        (0..self.roadmap.trees() as u32).map(ComponentId).filter(|&c| self.families.family(&self.roadmap, c) == c)
    }

    /// Every tree with the leaves that it has reached, sorted by state.
    #[must_use]
    pub fn leaves_by_tree(&self) -> Vec<(ComponentId, Vec<(StateId, LeafId)>)> {
        self.trees().map(|tree| (tree, self.leaves_of(tree))).collect()
    }

    fn leaves_of(&self, tree: ComponentId) -> Vec<(StateId, LeafId)> {
        let reached = self.members(tree).flat_map(|c| &self.reached.by_component[c.at()]);
        let mut leaves: Vec<_> = reached.map(|&leaf| (self.leaves.leaf(leaf).state, leaf)).collect();
        leaves.sort_unstable();
        leaves.dedup();
        leaves
    }

    /// All trees that have been joined into `tree`.
    fn members(&self, tree: ComponentId) -> impl Iterator<Item = ComponentId> {
        let all = 0..self.reached.by_component.len() as u32;
        all.map(ComponentId).filter(move |&c| self.families.family(&self.roadmap, c) == tree)
    }

    /// The nodes of a tree and of those planted for it on a leaf.
    fn nodes_on(&self, leaf: LeafId, tree: ComponentId) -> impl Iterator<Item = NodeId> {
        let nodes = self.roadmap.nodes_on(leaf).iter().copied();
        nodes.filter(move |&node| self.families.family_of(&self.roadmap, node) == tree)
    }
}

/// Chooses for every candidate that has none a node: the nearest on its leaf where one is chosen already, else as
/// [`SearchSettings::selection`] says.
pub fn select_nodes(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_>,
    arena: Res<'_, CandidateArena>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    let trees = explored.leaves_by_tree();
    let roadmap = &*explored.roadmap;
    let mut pool: Vec<_> = candidates.iter_mut().collect();
    pool.par_iter_mut().filter(|c| c.is_alive() && c.near.is_none()).for_each(|candidate| {
        let mut rng = stream(settings.seed, Purpose::Select, step.step, candidate.index);
        let q = arena.random_of(candidate.index);
        let nearest_on = |leaf, tree| model.nearest(roadmap, q, explored.nodes_on(leaf, tree), &model.robot_weights);
        let chosen = match (candidate.leaf, candidate.component, settings.selection) {
            (Some(leaf), Some(tree), _) => nearest_on(leaf, tree),
            (_, _, Selection::Nearest) => {
                let all = (0..roadmap.nodes().len() as u32).map(NodeId);
                model.nearest(roadmap, q, all, &model.weights)
            }
            (_, _, Selection::StateFirst) => trees.choose(&mut rng).and_then(|(tree, leaves)| {
                let nodes = one_state(leaves, &mut rng)?.iter().flat_map(|&(_, leaf)| explored.nodes_on(leaf, *tree));
                model.nearest(roadmap, q, nodes, &model.weights)
            }),
            (_, _, Selection::LeafFirst | Selection::Guided) => trees.choose(&mut rng).and_then(|(tree, leaves)| {
                // States with few leaves are often the narrow ones (one leaf holds every solid grasp of an object), so
                // leaves alone would starve them.
                let &(_, leaf) = one_state(leaves, &mut rng)?.choose(&mut rng)?;
                nearest_on(leaf, *tree)
            }),
        };
        match chosen {
            Some(node) => {
                candidate.near = Some(node);
                candidate.component = Some(explored.families.family_of(roadmap, node));
            }
            None => candidate.reject(Rejection::NoNode),
        }
    });
}

/// The leaves of one of the states.
fn one_state<'a>(leaves: &'a [(StateId, LeafId)], rng: &mut impl Rng) -> Option<&'a [(StateId, LeafId)]> {
    let states: Vec<_> = leaves.chunk_by(|a, b| a.0 == b.0).collect();
    states.choose(rng).copied()
}

/// Draws for every candidate that has none a transition that leaves its node's state, in proportion to the weights.
pub fn select_transitions(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    step: Res<'_, StepCounter>,
    explored: Explored<'_>,
    weights: Res<'_, TransitionWeights>,
    mut aims: ResMut<'_, Aims>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    for mut candidate in candidates.iter_mut().filter(|c| c.is_alive() && c.transition.is_none()) {
        let Some(near) = candidate.near else {
            candidate.reject(Rejection::NoNode);
            continue;
        };
        let mut rng = stream(settings.seed, Purpose::Select, step.step, candidate.index | 1 << 31);
        let row = explored.roadmap.node(near);
        aims.count_try(row.leaf);
        let from = explored.leaves.leaf(row.leaf);
        let aim = candidate.aim.map(|aim| explored.leaves.leaf(aim));
        let weigh = |(id, transition): (TransitionId, &Transition)| {
            let preference = aim.map_or(1.0, |aim| aims.preference(&model.graph, from, transition, aim));
            (id, weights.0[id.at()] * preference)
        };
        let choices: Vec<_> = model.graph.leaving(row.state).map(weigh).collect();
        match draw(&choices, rng.random()) {
            Some(transition) => candidate.transition = Some(transition),
            None => candidate.reject(Rejection::NoTransition),
        }
    }
}
