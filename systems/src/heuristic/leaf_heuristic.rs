//! Set Select, the guided half: a leaf that is few grasps from what another tree has reached, and the leaf to aim at.

use crate::exploration::explored::Explored;
use crate::exploration::reached_leaves::{LeafParameterColumns, ReachedLeaves};
use crate::heuristic::corridor::Corridor;
use crate::heuristic::grasp_distance::GraspDistance;
use crate::heuristic::leaf_distance_table::{End, LeafDistanceTable};
use crate::heuristic::measured_leaves::{Measured, Nearest};
use crate::heuristic::pair_tables::PairTables;
use crate::heuristic::weighted_leaves::{FOCUS, Weighted, WeightedLeaves, in_state};
use crate::heuristic::weighted_sampling::{Reached, draw_weighted};
use bevy_ecs::prelude::Resource;
use foliate_components::graph::leaf::{Leaf, LeafId, LeafIndex};
use foliate_components::graph::{ConstraintGraph, StateId, Transition};
use foliate_components::roadmap::{Roadmap, TreeId};
use foliate_kernels::lanes::Level;
use rand::{Rng, RngExt};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// So many leaves of a state are measured one by one.
const FEW: usize = 8;

/// How far every leaf is from every tree, kept from step to step.
#[derive(Clone, Debug, Default, Resource)]
pub struct LeafHeuristic {
    pub(crate) distance: GraspDistance,
    /// By the states of two leaves.
    pub(crate) pairs: PairTables,
    /// By tree as it was born: what is known of the leaves it has reached.
    pub(crate) measured: Vec<Measured>,
    /// By tree as it is now: its leaves by state, sorted; empty for a tree that has been joined to another.
    pub(crate) trees: Vec<Vec<WeightedLeaves>>,
    /// By leaf: candidates that started there.
    pub(crate) tries: Vec<u32>,
    /// By leaf: changes of grasp that the way from there takes beyond its distance.
    pub(crate) detours: Vec<u16>,
    /// Leaves on which the last step's candidates have started.
    touched: Vec<LeafId>,
    /// Leaves that no way leads to any more, by tree.
    pub(crate) lost: BTreeSet<(TreeId, LeafId)>,
    /// [`ReachedLeaves::cleared`] of what is measured.
    cleared: u32,
    /// Where there is one, no transition leaves it.
    pub(crate) corridor: Option<Corridor>,
}

impl LeafHeuristic {
    /// Changes of grasp from a leaf that the tree `tree` has reached to the nearest leaf of any other tree.
    #[must_use]
    pub fn to_others(&self, leaf: LeafId, tree: TreeId) -> Option<u16> {
        self.trees.get(tree.at())?.iter().find_map(|state| state.get(leaf)).map(|weighted| weighted.far)
    }

    /// Of the leaves that a tree has reached the one that is most likely to be chosen, and how many changes of grasp lie between it and
    /// what another tree has reached; of equals the one of the first state, and of these the first.
    #[must_use]
    pub fn heaviest(&self, tree: TreeId) -> Option<(u16, LeafId)> {
        let states = self.trees.get(tree.at())?.iter().filter_map(WeightedLeaves::heaviest);
        let heaviest = states.reduce(|most, next| if next.0 > most.0 { next } else { most });
        heaviest.map(|(_, weighted)| (weighted.far, weighted.leaf))
    }

    /// Hears which leaves no way leads to any more, by tree: they are neither chosen nor aimed at. Distances to them still count.
    pub fn lose(&mut self, lost: BTreeSet<(TreeId, LeafId)>, leaves: &LeafIndex) {
        let before = std::mem::replace(&mut self.lost, lost);
        for &(tree, leaf) in before.symmetric_difference(&self.lost) {
            let is_lost = self.lost.contains(&(tree, leaf));
            let states = self.trees.get_mut(tree.at()).map(Vec::as_mut_slice);
            if let Some(leaves) = states.and_then(|states| in_state(states, leaves.leaf(leaf).state)) {
                leaves.change(leaf, |weighted| weighted.lost = is_lost);
            }
        }
    }

    /// Forgets what was measured of leaves that are not reached any more.
    pub(crate) fn follow_losses(&mut self, reached: &ReachedLeaves) {
        if std::mem::replace(&mut self.cleared, reached.cleared()) != reached.cleared() {
            self.measured.clear();
            self.trees.clear();
        }
    }

    /// How much likelier transitions that leave the state of `from` get by what they lead to: those that lead equally far share one
    /// weight, which halves with every change of grasp that is left. So however many objects there are to take hold of, those that
    /// have to be moved are tried as often as all others together.
    pub fn preferences<'t>(
        &self,
        graph: &ConstraintGraph,
        from: &Leaf,
        target_leaf: &Leaf,
        transitions: impl IntoIterator<Item = &'t Transition>,
    ) -> Vec<f64> {
        let far = self.distance.after_each(graph, from, target_leaf, transitions);
        let nearest = far.iter().copied().min().unwrap_or(0);
        let mut alike = vec![0u32; far.iter().map(|&far| usize::from(far - nearest) + 1).max().unwrap_or(0)];
        far.iter().for_each(|&far| alike[usize::from(far - nearest)] += 1);
        let share = |&far: &u16| FOCUS.powi(-i32::from(far - nearest)) / f64::from(alike[usize::from(far - nearest)]);
        far.iter().map(share).collect()
    }

    /// Remembers that a candidate has started on a leaf.
    pub fn count_try(&mut self, leaf: LeafId) {
        if let Some(tries) = self.tries.get_mut(leaf.at()) {
            *tries += 1;
            self.touched.push(leaf);
        }
    }

    fn weighted(&self, leaf: LeafId, far: u16, tree: TreeId) -> Weighted {
        let detours = self.detours.get(leaf.at()).copied().unwrap_or(0);
        Weighted { leaf, far, detours, tries: self.tries[leaf.at()], lost: self.lost.contains(&(tree, leaf)) }
    }

    /// The leaves that a tree has reached, with what is known of each.
    fn gather(&self, reached: &ReachedLeaves, roadmap: Roadmap<'_>, tree: TreeId) -> Vec<WeightedLeaves> {
        let mut states: Vec<(StateId, Vec<Weighted>)> = Vec::new();
        let born = (0u32..).map(TreeId).zip(&self.measured).filter(|&(c, _)| roadmap.tree(c) == tree);
        for (born, measured) in born {
            let list = &reached.by_born_tree[born.at()];
            for (nearest, columns) in measured.states.iter().zip(reached.columns_of(born)) {
                let entry = |(index, &place): (usize, &u32)| {
                    let leaf = list[place as usize];
                    let far = nearest.to_others(roadmap, tree, index).unwrap_or(0);
                    self.weighted(leaf, far, tree)
                };
                let new = columns.places[..nearest.known].iter().enumerate().map(entry);
                let at = states.partition_point(|(state, _)| *state < columns.state);
                if states.get(at).is_none_or(|(state, _)| *state != columns.state) {
                    states.insert(at, (columns.state, Vec::new()));
                }
                states[at].1.extend(new);
            }
        }
        let sort = |(state, mut leaves): (StateId, Vec<Weighted>)| {
            leaves.sort_by_key(|w| (w.leaf, w.far));
            leaves.dedup_by_key(|w| w.leaf);
            WeightedLeaves::new(state, leaves)
        };
        states.into_iter().map(sort).collect()
    }

    /// Chooses what to aim at from `leaf`: among the leaves that other trees have reached, near ones first.
    pub(crate) fn target_leaf(
        &self,
        graph: &ConstraintGraph,
        explored: &Explored<'_, '_>,
        (leaf, tree): (LeafId, TreeId),
        level: Level,
        rng: &mut impl Rng,
        scratch: &mut HeuristicScratch,
    ) -> Option<LeafId> {
        let from = explored.leaves.leaf(leaf);
        let lists = (0u32..).map(TreeId).zip(&explored.reached.by_born_tree);
        let others = lists.filter(|&(born, _)| explored.roadmap().tree(born) != tree);
        let (trees, others): (Vec<_>, Vec<_>) = others
            .map(|(born, leaves)| {
                let tree = explored.roadmap().tree(born);
                (tree, Reached { leaves, columns: explored.reached.columns_of(born) })
            })
            .unzip();
        scratch.far.clear();
        let mut nearest = u16::MAX;
        for (&tree, other) in trees.iter().zip(&others) {
            for columns in other.columns {
                let start = scratch.far.len();
                scratch.far.resize(start + columns.len(), 0);
                let far = &mut scratch.far[start..];
                let pair = self.pair(graph, from.state, columns.state);
                let leaves = columns.places.iter().map(|&place| other.leaves[place as usize]);
                let mut least = u16::MAX;
                if columns.len() <= FEW {
                    for (far, leaf) in far.iter_mut().zip(leaves.clone()) {
                        *far = pair.distance(&from.parameters, &explored.leaves.leaf(leaf).parameters);
                        least = least.min(*far);
                    }
                } else {
                    let distances = pair.distances(&from.parameters, End::From, &columns.parameters);
                    least = distances.measure(level, far);
                }
                if !self.lost.is_empty() {
                    let lost = far.iter_mut().zip(leaves).filter(|&(_, leaf)| self.lost.contains(&(tree, leaf)));
                    lost.for_each(|(far, _)| *far = u16::MAX);
                    least = far.iter().copied().min().unwrap_or(u16::MAX);
                }
                nearest = nearest.min(least);
            }
        }
        draw_weighted(level, &others, (&scratch.far, nearest), rng.random(), &mut scratch.sums)
    }

    pub(crate) fn pair(&self, graph: &ConstraintGraph, from: StateId, to: StateId) -> Cow<'_, LeafDistanceTable> {
        match self.pairs.get(from, to) {
            Some(pair) => Cow::Borrowed(pair),
            None => Cow::Owned(self.distance.between_states(graph, from, to)),
        }
    }
}

/// Buffers of one thread.
#[derive(Default)]
pub(crate) struct HeuristicScratch {
    /// Distances to all leaves of other trees, tree by tree and state by state.
    far: Vec<u16>,
    sums: Vec<u64>,
}

impl LeafHeuristic {
    /// Weighs afresh what trees have reached that others have been joined to.
    pub(crate) fn follow_joins(&mut self, explored: &Explored<'_, '_>) {
        let mut joined = Vec::new();
        for (born, states) in (0u32..).map(TreeId).zip(&mut self.trees) {
            let tree = explored.roadmap().tree(born);
            if tree != born && !states.is_empty() {
                states.clear();
                joined.push(tree);
            }
        }
        joined.sort_unstable();
        joined.dedup();
        for tree in joined {
            self.trees[tree.at()] = self.gather(&explored.reached, explored.roadmap(), tree);
        }
    }

    /// Weighs afresh the leaves on which candidates have started.
    pub(crate) fn follow_tries(&mut self, explored: &Explored<'_, '_>) {
        for leaf in std::mem::take(&mut self.touched) {
            let (state, tries) = (explored.leaves.leaf(leaf).state, self.tries[leaf.at()]);
            for tree in &mut self.trees {
                if let Some(leaves) = in_state(tree, state) {
                    leaves.change(leaf, |weighted| weighted.tries = tries);
                }
            }
        }
    }

    /// Measures the next leaf that the tree `born` has reached against what is measured of all other trees.
    pub(crate) fn measure(
        &mut self,
        graph: &ConstraintGraph,
        explored: &Explored<'_, '_>,
        level: Level,
        (born, id): (TreeId, LeafId),
    ) {
        let leaf = explored.leaves.leaf(id);
        let own = explored.roadmap().tree(born);
        let mut from_here: Vec<(usize, u16)> = Vec::new();
        for other in (0..self.measured.len() as u32).map(TreeId) {
            if explored.roadmap().tree(other) == own {
                continue;
            }
            let mut nearest = None;
            for (state, columns) in explored.reached.columns_of(other).iter().enumerate() {
                let Some(known) = self.measured[other.at()].states.get(state).map(|s| s.known) else { break };
                let distance = &self.distance;
                let table = || distance.between_states(graph, leaf.state, columns.state);
                let pair = self.pairs.get_or_insert((leaf.state, columns.state), table);
                if nearest.is_none_or(|nearest| pair.least < nearest) {
                    let here = if known <= FEW {
                        let to = leaves_of(explored, other, columns).take(known);
                        to.map(|to| pair.distance(&leaf.parameters, &to.parameters)).min().unwrap_or(u16::MAX)
                    } else {
                        pair.distances(&leaf.parameters, End::From, &columns.parameters).nearest(level, known)
                    };
                    nearest = nearest.into_iter().chain((known > 0).then_some(here)).min();
                }
                self.come_nearer(graph, explored, level, (other, state), (born, leaf));
            }
            from_here.extend(nearest.map(|nearest| (other.at(), nearest)));
        }
        self.add(explored, (born, own), id, &from_here);
    }

    /// Measures the leaves of one state that the tree `born` has reached against a new leaf of the tree `to`.
    fn come_nearer(
        &mut self,
        graph: &ConstraintGraph,
        explored: &Explored<'_, '_>,
        level: Level,
        (born, state): (TreeId, usize),
        (to, leaf): (TreeId, &Leaf),
    ) {
        let tree = explored.roadmap().tree(born);
        let columns = &explored.reached.columns_of(born)[state];
        let distance = &self.distance;
        let table = || distance.between_states(graph, columns.state, leaf.state);
        let pair = self.pairs.get_or_insert((columns.state, leaf.state), table);
        let mut nearer = Vec::new();
        let nearest = if columns.len() <= FEW {
            let nearest = &mut self.measured[born.at()].states[state];
            let known = nearest.of(to.at()).iter_mut().zip(leaves_of(explored, born, columns));
            for (index, (known, from)) in known.enumerate() {
                let far = pair.distance(&from.parameters, &leaf.parameters);
                if far < *known {
                    *known = far;
                    nearer.push(index);
                }
            }
            nearest
        } else {
            let distances = pair.distances(&leaf.parameters, End::To, &columns.parameters);
            if distances.has_nothing_in_common() && self.knows_state(explored, to, leaf.state) {
                // No leaf is nearer to this one than to another of the same state that has been measured.
                return;
            }
            let nearest = &mut self.measured[born.at()].states[state];
            distances.lower(level, nearest.of(to.at()), &mut nearer);
            nearest
        };
        let Some(leaves) = in_state(&mut self.trees[tree.at()], columns.state) else { return };
        for index in nearer {
            let leaf = explored.reached.by_born_tree[born.at()][columns.places[index] as usize];
            let far = nearest.to_others(explored.roadmap(), tree, index).unwrap_or(0);
            leaves.change(leaf, |weighted| weighted.far = far);
        }
    }

    /// Whether any leaf of a state that the tree `born` has reached has been measured in the graph as it is.
    fn knows_state(&self, explored: &Explored<'_, '_>, born: TreeId, state: StateId) -> bool {
        let columns = explored.reached.columns_of(born).iter();
        columns
            .zip(&self.measured[born.at()].states)
            .any(|(columns, nearest)| columns.state == state && nearest.known > nearest.stale)
    }

    /// Adds a leaf that is so far from other trees to what is known of its own.
    fn add(&mut self, explored: &Explored<'_, '_>, (born, own): (TreeId, TreeId), id: LeafId, far: &[(usize, u16)]) {
        let state = explored.leaves.leaf(id).state;
        let columns = explored.reached.columns_of(born);
        let at = columns.iter().position(|c| c.state == state).unwrap_or(0);
        let measured = &mut self.measured[born.at()];
        measured.known += 1;
        if measured.states.len() <= at {
            measured.states.resize_with(at + 1, Nearest::default);
        }
        let nearest = &mut measured.states[at];
        nearest.known += 1;
        for &(tree, far) in far {
            if let Some(last) = nearest.of(tree).last_mut() {
                *last = far;
            }
        }
        let far = far.iter().map(|&(_, far)| far).min().unwrap_or(0);
        let new = self.weighted(id, far, own);
        let states = &mut self.trees[own.at()];
        match in_state(states, state) {
            Some(leaves) => leaves.insert(new),
            None => {
                let at = states.partition_point(|s| s.state < state);
                states.insert(at, WeightedLeaves::new(state, vec![new]));
            }
        }
    }
}

/// The leaves of one state that the tree `born` has reached, in order of first visit.
fn leaves_of<'a>(
    explored: &'a Explored<'_, '_>,
    born: TreeId,
    columns: &'a LeafParameterColumns,
) -> impl Iterator<Item = &'a Leaf> {
    let list = &explored.reached.by_born_tree[born.at()];
    columns.places.iter().map(|&place| explored.leaves.leaf(list[place as usize]))
}
