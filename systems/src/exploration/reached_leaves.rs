//! Which leaves each tree has reached, kept by the commit so that no step has to count them again.

use crate::exploration::parameter_column::ParameterColumn;
use crate::exploration::visited_leaves::VisitedLeaves;
use bevy_ecs::prelude::Resource;
use foliate_components::graph::StateId;
use foliate_components::graph::leaf::{Leaf, LeafId};
use foliate_components::roadmap::TreeId;
use std::collections::HashSet;
use std::ops::Range;

/// The leaves that trees have reached: of every tree as it was born, in order of first visit, and of every tree as it is
/// now, sorted.
#[derive(Clone, Debug, Default, Resource)]
pub struct ReachedLeaves {
    /// By tree as it was born: its leaves in order of first visit.
    pub by_born_tree: Vec<Vec<LeafId>>,
    /// The same by state, with the leaves' parameters in columns.
    columns: Vec<Vec<LeafParameterColumns>>,
    /// Which tree, as it was born, has reached which leaf.
    seen: HashSet<(TreeId, LeafId)>,
    /// By tree as it is now: its leaves by state. Empty for a tree that has been joined to another.
    trees: Vec<Vec<StateLeaves>>,
    /// How often each leaf has been reached, sorted by state.
    visited: Vec<VisitedLeaves>,
    /// How often all of this was begun again.
    cleared: u32,
}

/// The leaves of one state that a tree has reached, sorted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateLeaves {
    /// The state.
    pub state: StateId,
    /// Its leaves, by id.
    pub leaves: Vec<LeafId>,
}

/// The leaves of one state that a tree has reached, in order of first visit, as columns: comparing one leaf with
/// all of them reads numbers in order.
#[derive(Clone, Debug)]
pub struct LeafParameterColumns {
    /// The state.
    pub state: StateId,
    /// By leaf: its place in [`ReachedLeaves::by_born_tree`].
    pub places: Vec<u32>,
    /// By foliating constraint of the state, then by leaf.
    pub parameters: Vec<ParameterColumn>,
    /// By block of places: how many of these leaves lie before it.
    starts: Vec<u32>,
}

impl ReachedLeaves {
    /// Begins again: nothing is reached.
    pub(crate) fn clear(&mut self) {
        *self = Self { cleared: self.cleared + 1, ..Self::default() };
    }

    /// How often it has begun again: what is derived from lists of leaves holds for one number.
    #[must_use]
    pub fn cleared(&self) -> u32 {
        self.cleared
    }

    /// Remembers that the tree `born`, which belongs to `tree` by now, has got a node on a leaf.
    pub fn visit(&mut self, born: TreeId, tree: TreeId, id: LeafId, leaf: &Leaf) {
        if self.seen.insert((born, id)) {
            self.add(born, tree, id, leaf);
        }
        let at = self.visited.partition_point(|visited| visited.state < leaf.state);
        if self.visited.get(at).is_none_or(|visited| visited.state != leaf.state) {
            self.visited.insert(at, VisitedLeaves::new(leaf));
        }
        self.visited[at].visit(tree, id, leaf);
    }

    fn add(&mut self, born: TreeId, tree: TreeId, id: LeafId, leaf: &Leaf) {
        let trees = born.max(tree).at() + 1;
        if self.by_born_tree.len() < trees {
            self.by_born_tree.resize_with(trees, Vec::new);
            self.columns.resize_with(trees, Vec::new);
            self.trees.resize_with(trees, Vec::new);
        }
        let place = self.by_born_tree[born.at()].len() as u32;
        self.by_born_tree[born.at()].push(id);
        let columns = &mut self.columns[born.at()];
        let known = columns.iter().position(|c| c.state == leaf.state);
        let at = known.unwrap_or_else(|| {
            columns.push(LeafParameterColumns::new(leaf));
            columns.len() - 1
        });
        columns[at].push(place, leaf);
        insert(&mut self.trees[tree.at()], leaf.state, &[id]);
    }

    /// Gives what the tree `absorbed` has reached to the tree `tree`, to which it has been joined.
    pub(crate) fn join(&mut self, tree: TreeId, absorbed: TreeId) {
        if tree == absorbed || self.trees.len() <= tree.max(absorbed).at() {
            return;
        }
        for reached in std::mem::take(&mut self.trees[absorbed.at()]) {
            insert(&mut self.trees[tree.at()], reached.state, &reached.leaves);
        }
        self.visited.iter_mut().for_each(|visited| visited.join(tree, absorbed));
    }

    /// What a tree has reached, by state; nothing where it has been joined to another.
    #[must_use]
    pub fn of_tree(&self, tree: TreeId) -> &[StateLeaves] {
        self.trees.get(tree.at()).map_or(&[], Vec::as_slice)
    }

    /// What a tree reached while it had this id, by state in order of first visit.
    #[must_use]
    pub fn columns_of(&self, born: TreeId) -> &[LeafParameterColumns] {
        self.columns.get(born.at()).map_or(&[], Vec::as_slice)
    }

    /// How often leaves have been reached, by state.
    pub(crate) fn visited(&self) -> &[VisitedLeaves] {
        &self.visited
    }
}

impl LeafParameterColumns {
    /// Places per block.
    pub(crate) const BLOCK: usize = 512;

    fn new(leaf: &Leaf) -> Self {
        let parameters = vec![ParameterColumn::default(); leaf.parameters.len()];
        Self { state: leaf.state, places: Vec::new(), parameters, starts: Vec::new() }
    }

    fn push(&mut self, place: u32, leaf: &Leaf) {
        self.starts.resize(place as usize / Self::BLOCK + 1, self.places.len() as u32);
        self.places.push(place);
        for (column, &parameter) in self.parameters.iter_mut().zip(&leaf.parameters) {
            column.push(parameter);
        }
    }

    /// Which of these leaves have a place in a block.
    #[inline]
    pub(crate) fn block(&self, number: usize) -> Range<usize> {
        let start = |number: usize| self.starts.get(number).map_or(self.places.len(), |&start| start as usize);
        start(number)..start(number + 1)
    }

    /// How many leaves.
    #[must_use]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }
}

/// Puts leaves of one state, sorted, where they belong.
fn insert(states: &mut Vec<StateLeaves>, state: StateId, new: &[LeafId]) {
    let at = states.partition_point(|s| s.state < state);
    if states.get(at).is_none_or(|s| s.state != state) {
        states.insert(at, StateLeaves { state, leaves: Vec::new() });
    }
    let leaves = &mut states[at].leaves;
    match (new, leaves.last()) {
        ([], _) => {}
        ([first, ..], Some(last)) if first <= last => match *new {
            [leaf] => {
                if let Err(at) = leaves.binary_search(&leaf) {
                    leaves.insert(at, leaf);
                }
            }
            _ => {
                leaves.extend_from_slice(new);
                leaves.sort_unstable();
                leaves.dedup();
            }
        },
        _ => leaves.extend_from_slice(new),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::graph::leaf::ParameterId;

    fn leaf(state: u32, parameter: u32) -> Leaf {
        Leaf { state: StateId(state), parameters: Box::new([ParameterId(parameter)]) }
    }

    fn seen(reached: &ReachedLeaves, tree: u32) -> Vec<(u32, Vec<u32>)> {
        let states = reached.of_tree(TreeId(tree)).iter();
        states.map(|s| (s.state.0, s.leaves.iter().map(|l| l.0).collect())).collect()
    }

    #[test]
    fn trees_that_are_joined_share_their_leaves_and_visits_keep_their_order() {
        let mut reached = ReachedLeaves::default();
        let (a, b) = (TreeId(0), TreeId(1));
        for (tree, id, state) in [(a, 5, 1), (a, 2, 0), (b, 5, 1), (b, 3, 1), (a, 9, 1), (a, 7, 1), (a, 9, 1)] {
            reached.visit(tree, tree, LeafId(id), &leaf(state, id));
        }
        assert_eq!(seen(&reached, 0), [(0, vec![2]), (1, vec![5, 7, 9])]);
        assert_eq!(seen(&reached, 1), [(1, vec![3, 5])]);
        reached.join(a, b);
        assert_eq!(seen(&reached, 0), [(0, vec![2]), (1, vec![3, 5, 7, 9])]);
        assert_eq!(seen(&reached, 1), []);
        reached.visit(b, a, LeafId(11), &leaf(2, 11));
        assert_eq!(seen(&reached, 0).last(), Some(&(2, vec![11])));

        assert_eq!(reached.by_born_tree[0], [5, 2, 9, 7].map(LeafId));
        let columns = reached.columns_of(a);
        assert_eq!((columns[0].state, &columns[0].places), (StateId(1), &vec![0, 2, 3]));
        assert_eq!(columns[0].parameters[0].values(), [5, 9, 7].map(ParameterId));
        assert!([9, 2].map(|value| columns[0].parameters[0].has(ParameterId(value))) == [true, false]);
    }
}
