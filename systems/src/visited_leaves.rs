//! How often trees have reached the leaves of a state, and draws by that (P0 eq. 12).
//!
//! Leaves stand in order of id, their parameters and visits in columns, so that a draw is one pass over numbers: sums of
//! blocks first, then the block in which the draw falls.

use foliate_components::graph::StateId;
use foliate_components::leaf::{Leaf, LeafId, ParameterId};
use foliate_components::roadmap::ComponentId;
use foliate_kernels::lanes::{Isa, Kernel, Level};

/// Leaves whose visits are summed at once.
const BLOCK: usize = 128;

/// The leaves of one state that trees have reached.
#[derive(Clone, Debug)]
pub(crate) struct VisitedLeaves {
    /// The state.
    pub state: StateId,
    /// By id.
    leaves: Vec<LeafId>,
    /// By foliating constraint of the state, then by leaf.
    parameters: Vec<Vec<ParameterId>>,
    /// By leaf: how many nodes lie on it. No sum of these exceeds the number of nodes, which fits.
    visits: Vec<u32>,
    /// The same by tree as it is now.
    by_tree: Vec<(ComponentId, TreeVisits)>,
}

/// How many nodes of one tree lie on each leaf, from the first to the last that it has reached.
#[derive(Clone, Debug, Default)]
struct TreeVisits {
    first: usize,
    visits: Vec<u32>,
}

impl VisitedLeaves {
    /// None yet of the state of a leaf.
    pub fn new(leaf: &Leaf) -> Self {
        Self {
            state: leaf.state,
            leaves: Vec::new(),
            parameters: vec![Vec::new(); leaf.parameters.len()],
            visits: Vec::new(),
            by_tree: Vec::new(),
        }
    }

    /// Remembers that a tree has got a node on a leaf.
    pub fn visit(&mut self, tree: ComponentId, id: LeafId, leaf: &Leaf) {
        let at = match self.leaves.last() {
            Some(&last) if last >= id => self.leaves.partition_point(|&known| known < id),
            _ => self.leaves.len(),
        };
        if self.leaves.get(at) != Some(&id) {
            self.leaves.insert(at, id);
            self.visits.insert(at, 0);
            for (column, &parameter) in self.parameters.iter_mut().zip(&leaf.parameters) {
                column.insert(at, parameter);
            }
            self.by_tree.iter_mut().for_each(|(_, visits)| visits.make_room(at));
        }
        self.visits[at] += 1;
        self.of(tree).add(at, 1);
    }

    /// Gives the visits of the tree `absorbed` to the tree `tree`, to which it has been joined.
    pub fn join(&mut self, tree: ComponentId, absorbed: ComponentId) {
        let Some(at) = self.by_tree.iter().position(|(known, _)| *known == absorbed) else { return };
        let (_, given) = self.by_tree.swap_remove(at);
        let kept = self.of(tree);
        for (at, &visits) in given.visits.iter().enumerate().filter(|(_, visits)| **visits > 0) {
            kept.add(given.first + at, visits);
        }
    }

    fn of(&mut self, tree: ComponentId) -> &mut TreeVisits {
        let known = self.by_tree.iter().position(|(known, _)| *known == tree);
        let at = known.unwrap_or_else(|| {
            self.by_tree.push((tree, TreeVisits::default()));
            self.by_tree.len() - 1
        });
        &mut self.by_tree[at].1
    }

    /// The leaves that trees other than one have reached, of which a draw takes those that have some values: by position of
    /// the constraint in the state's foliation.
    pub fn reached_by_others(
        &self,
        tree: ComponentId,
        wanted: impl Iterator<Item = (usize, ParameterId)>,
    ) -> Choices<'_> {
        let own = self.by_tree.iter().find(|(known, _)| *known == tree).map(|(_, visits)| visits);
        let wanted = wanted.map(|(row, value)| (self.parameters[row].as_slice(), value)).collect();
        Choices { of: self, own, wanted }
    }
}

impl TreeVisits {
    /// Hears that a leaf has come to stand at a place where others were.
    fn make_room(&mut self, at: usize) {
        if at <= self.first {
            self.first += 1;
        } else if at < self.first + self.visits.len() {
            self.visits.insert(at - self.first, 0);
        }
    }

    fn add(&mut self, at: usize, visits: u32) {
        if self.visits.is_empty() {
            self.first = at;
        }
        if at < self.first {
            self.visits.splice(0..0, std::iter::repeat_n(0, self.first - at));
            self.first = at;
        }
        let own = at - self.first;
        if own >= self.visits.len() {
            self.visits.resize(own + 1, 0);
        }
        self.visits[own] += visits;
    }

    /// Takes the visits from those of a block that begins at `start`.
    #[inline(always)]
    fn take_from(&self, start: usize, block: &mut [u32; BLOCK]) {
        let (low, high) = (self.first.max(start), (self.first + self.visits.len()).min(start + BLOCK));
        if low < high {
            for (visits, own) in block[low - start..].iter_mut().zip(&self.visits[low - self.first..high - self.first])
            {
                *visits -= own;
            }
        }
    }
}

/// Leaves of one state among which to draw.
pub(crate) struct Choices<'a> {
    of: &'a VisitedLeaves,
    /// Visits that do not count.
    own: Option<&'a TreeVisits>,
    wanted: Vec<(&'a [ParameterId], ParameterId)>,
}

impl Choices<'_> {
    /// By leaf of the block that begins at `start`: visits that count.
    #[inline(always)]
    fn weights(&self, start: usize) -> [u32; BLOCK] {
        let mut weights = [0; BLOCK];
        let count = (self.of.leaves.len() - start).min(BLOCK);
        weights[..count].copy_from_slice(&self.of.visits[start..start + count]);
        if let Some(own) = self.own {
            own.take_from(start, &mut weights);
        }
        for &(column, value) in &self.wanted {
            for (weight, &other) in weights.iter_mut().zip(&column[start..start + count]) {
                *weight = if other == value { *weight } else { 0 };
            }
        }
        weights
    }
}

/// Sums of the weights of blocks, those of one state after those of another.
struct BlockSums<'a> {
    choices: &'a [Choices<'a>],
    out: &'a mut Vec<u32>,
}

impl Kernel for BlockSums<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, _: I) {
        for choices in self.choices {
            for start in (0..choices.of.leaves.len()).step_by(BLOCK) {
                let weights = choices.weights(start);
                let mut sum = 0;
                for weight in weights {
                    sum += weight;
                }
                self.out.push(sum);
            }
        }
    }
}

/// Draws a leaf by `u` ∈ [0, 1), in proportion to the visits that count; nothing where there are none.
pub(crate) fn draw_by_visits(level: Level, choices: &[Choices<'_>], u: f64) -> Option<LeafId> {
    let mut sums = Vec::new();
    level.run(BlockSums { choices, out: &mut sums });
    let sum: u64 = sums.iter().map(|&sum| u64::from(sum)).sum();
    // Whole numbers, so that their order does not matter; rounding must not lead behind the last one.
    let mut left = ((u * sum as f64) as u64).min(sum.checked_sub(1)?);
    let mut is_here = |&weight: &u32| {
        let is_here = left < u64::from(weight);
        left -= if is_here { 0 } else { u64::from(weight) };
        is_here
    };
    let mut block = sums.iter().position(&mut is_here)?;
    for choices in choices {
        let blocks = choices.of.leaves.len().div_ceil(BLOCK);
        if block < blocks {
            let start = block * BLOCK;
            return choices.weights(start).iter().position(is_here).map(|at| choices.of.leaves[start + at]);
        }
        block -= blocks;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::draw;
    use std::collections::BTreeMap;

    fn leaf(id: u32) -> Leaf {
        Leaf { state: StateId(0), parameters: Box::new([ParameterId(id % 7), ParameterId(id % 3)]) }
    }

    #[test]
    fn a_draw_from_blocks_is_the_draw_from_a_list() {
        // Neither in order nor once each; the trees 1 and 3 are joined on the way.
        let visits = |i: u32| (ComponentId([0, 1, 2, 3, 0][(i * 31 % 5) as usize]), LeafId(i * 387 % 500));
        let mut visited = VisitedLeaves::new(&leaf(0));
        let mut counted: BTreeMap<(LeafId, ComponentId), f64> = BTreeMap::new();
        for i in 0..1500 {
            let (tree, id) = visits(i);
            let joined = if i >= 700 && tree.0 == 3 { ComponentId(1) } else { tree };
            visited.visit(joined, id, &leaf(id.0));
            *counted.entry((id, if tree.0 == 3 { ComponentId(1) } else { tree })).or_default() += 1.0;
            if i == 700 {
                visited.join(ComponentId(1), ComponentId(3));
            }
        }
        for tree in [0, 1, 2, 9].map(ComponentId) {
            for wanted in [vec![], vec![(0, ParameterId(5))], vec![(0, ParameterId(5)), (1, ParameterId(2))]] {
                let agrees = |id: LeafId| wanted.iter().all(|&(row, value)| leaf(id.0).parameters[row] == value);
                let list: Vec<(LeafId, f64)> = counted
                    .iter()
                    .filter(|((id, of), _)| *of != tree && agrees(*id))
                    .map(|((id, _), visits)| (*id, *visits))
                    .collect();
                assert!(!list.is_empty());
                let choices = [visited.reached_by_others(tree, wanted.iter().copied())];
                for level in Level::available() {
                    for step in 0..=1000 {
                        let u = f64::from(step) / 1000.0;
                        assert_eq!(draw_by_visits(level, &choices, u), draw(&list, u), "{tree:?} {wanted:?} {u}");
                    }
                }
            }
        }
        let nobody = [visited.reached_by_others(ComponentId(0), [(0, ParameterId(99))].into_iter())];
        assert_eq!(draw_by_visits(Level::scalar(), &nobody, 0.5), None);
    }

    #[test]
    fn a_tree_with_one_leaf_takes_one_number() {
        let mut visited = VisitedLeaves::new(&leaf(0));
        (0..1000).for_each(|id| visited.visit(ComponentId(0), LeafId(id), &leaf(id)));
        visited.visit(ComponentId(1), LeafId(900), &leaf(900));
        assert_eq!(visited.by_tree[1].1.visits, [1]);
    }
}
