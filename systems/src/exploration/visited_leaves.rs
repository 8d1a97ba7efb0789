//! How often trees have reached the leaves of a state, and draws by that (P0 eq. 12).
//!
//! Leaves stand in order of id, their parameters and visits in columns, so that a draw is one pass over numbers: sums of
//! blocks first, then the block in which the draw falls.

use crate::exploration::parameter_column::ParameterColumn;
use foliate_components::graph::StateId;
use foliate_components::graph::leaf::{Leaf, LeafId, ParameterId};
use foliate_components::roadmap::TreeId;
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
    parameters: Vec<ParameterColumn>,
    /// By leaf: how many nodes lie on it.
    visits: Visits,
    /// The same by tree as it is now.
    by_tree: Vec<(TreeId, Visits)>,
}

/// How many nodes lie on each leaf, from the first to the last that has any. No sum of these exceeds the number of nodes,
/// which fits.
#[derive(Clone, Debug, Default)]
struct Visits {
    first: usize,
    visits: Vec<u32>,
    /// Sums by block of places.
    sums: Vec<u32>,
}

impl VisitedLeaves {
    /// None yet of the state of a leaf.
    pub fn new(leaf: &Leaf) -> Self {
        Self {
            state: leaf.state,
            leaves: Vec::new(),
            parameters: vec![ParameterColumn::default(); leaf.parameters.len()],
            visits: Visits::default(),
            by_tree: Vec::new(),
        }
    }

    /// Remembers that a tree has got a node on a leaf.
    pub fn visit(&mut self, tree: TreeId, id: LeafId, leaf: &Leaf) {
        let at = match self.leaves.last() {
            Some(&last) if last >= id => self.leaves.partition_point(|&known| known < id),
            _ => self.leaves.len(),
        };
        if self.leaves.get(at) != Some(&id) {
            self.leaves.insert(at, id);
            for (column, &parameter) in self.parameters.iter_mut().zip(&leaf.parameters) {
                column.insert(at, parameter);
            }
            self.visits.make_room(at);
            self.by_tree.iter_mut().for_each(|(_, visits)| visits.make_room(at));
        }
        self.visits.add(at, 1);
        self.of(tree).add(at, 1);
    }

    /// Gives the visits of the tree `absorbed` to the tree `tree`, to which it has been joined.
    pub fn join(&mut self, tree: TreeId, absorbed: TreeId) {
        let Some(at) = self.by_tree.iter().position(|(known, _)| *known == absorbed) else { return };
        let (_, given) = self.by_tree.swap_remove(at);
        let kept = self.of(tree);
        for (at, &visits) in given.visits.iter().enumerate().filter(|(_, visits)| **visits > 0) {
            kept.add(given.first + at, visits);
        }
    }

    fn of(&mut self, tree: TreeId) -> &mut Visits {
        let known = self.by_tree.iter().position(|(known, _)| *known == tree);
        let at = known.unwrap_or_else(|| {
            self.by_tree.push((tree, Visits::default()));
            self.by_tree.len() - 1
        });
        &mut self.by_tree[at].1
    }

    /// The leaves that trees other than one have reached.
    pub fn reached_by_others(&self, tree: TreeId) -> Choices<'_> {
        let own = self.by_tree.iter().find(|(known, _)| *known == tree).map(|(_, visits)| visits);
        Choices { of: self, own, wanted: Vec::new() }
    }
}

impl Visits {
    /// Hears that a leaf has come to stand at a place where others were.
    fn make_room(&mut self, at: usize) {
        let end = self.first + self.visits.len();
        if at >= end {
            return;
        }
        let moved = at.max(self.first);
        if at <= self.first {
            self.first += 1;
        } else {
            self.visits.insert(at - self.first, 0);
        }
        self.sum_from(moved / BLOCK);
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
            self.sums.resize(at / BLOCK + 1, 0);
        }
        self.visits[own] += visits;
        self.sums[at / BLOCK] += visits;
    }

    fn sum_from(&mut self, block: usize) {
        self.sums.truncate(block);
        let blocks = (self.first + self.visits.len()).div_ceil(BLOCK);
        for number in self.sums.len()..blocks {
            let sum = self.block(number * BLOCK).iter().sum();
            self.sums.push(sum);
        }
    }

    fn sum(&self, block: usize) -> u32 {
        self.sums.get(block).copied().unwrap_or(0)
    }

    /// The visits of the block that begins at `start`.
    fn block(&self, start: usize) -> [u32; BLOCK] {
        let mut block = [0; BLOCK];
        let (low, high) = (self.first.max(start), (self.first + self.visits.len()).min(start + BLOCK));
        if low < high {
            block[low - start..high - start].copy_from_slice(&self.visits[low - self.first..high - self.first]);
        }
        block
    }
}

/// Leaves of one state among which to draw.
pub(crate) struct Choices<'a> {
    of: &'a VisitedLeaves,
    /// Visits that do not count.
    own: Option<&'a Visits>,
    wanted: Vec<(&'a [ParameterId], ParameterId)>,
}

impl<'a> Choices<'a> {
    /// Of these the leaves that have some values: by position of the constraint in the state's foliation. `None` where some
    /// value is nowhere.
    pub fn with(mut self, mut values: impl Iterator<Item = (usize, ParameterId)>) -> Option<Self> {
        let found = values.all(|(row, value)| {
            let column: &'a ParameterColumn = &self.of.parameters[row];
            self.wanted.push((column.values(), value));
            column.has(value)
        });
        found.then_some(self)
    }

    fn blocks(&self) -> usize {
        self.of.leaves.len().div_ceil(BLOCK)
    }

    /// By leaf of a block: whether it has what is wanted. Answers whether any has.
    #[inline(always)]
    fn has_wanted(&self, start: usize, has: &mut [bool; BLOCK]) -> bool {
        let mut any = true;
        *has = [true; BLOCK];
        for &(column, value) in &self.wanted {
            let column = &column[start..];
            match column.first_chunk::<BLOCK>() {
                Some(block) => {
                    for (has, &other) in has.iter_mut().zip(block) {
                        *has &= other == value;
                    }
                }
                None => {
                    for (index, has) in has.iter_mut().enumerate() {
                        *has &= column.get(index) == Some(&value);
                    }
                }
            }
            any = false;
            for &has in &*has {
                any |= has;
            }
            if !any {
                break;
            }
        }
        any
    }

    /// By leaf of a block: visits that count.
    fn weights(&self, start: usize, has: &[bool; BLOCK]) -> [u32; BLOCK] {
        let mut weights = self.of.visits.block(start);
        let own = self.own.map_or([0; BLOCK], |own| own.block(start));
        for ((weight, own), &has) in weights.iter_mut().zip(own).zip(has) {
            *weight = if has { *weight - own } else { 0 };
        }
        weights
    }

    /// The sum of a block's weights.
    #[inline(always)]
    fn sum(&self, block: usize) -> u32 {
        if self.wanted.is_empty() {
            return self.of.visits.sum(block) - self.own.map_or(0, |own| own.sum(block));
        }
        let mut has = [true; BLOCK];
        if self.has_wanted(block * BLOCK, &mut has) { self.weights(block * BLOCK, &has).iter().sum() } else { 0 }
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
            for block in 0..choices.blocks() {
                self.out.push(choices.sum(block));
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
        if block < choices.blocks() {
            let (start, mut has) = (block * BLOCK, [true; BLOCK]);
            choices.has_wanted(start, &mut has);
            return choices.weights(start, &has).iter().position(is_here).map(|at| choices.of.leaves[start + at]);
        }
        block -= choices.blocks();
    }
    None
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]
mod tests {
    use super::*;
    use crate::runtime::random::draw;
    use std::collections::BTreeMap;

    fn leaf(id: u32) -> Leaf {
        Leaf { state: StateId(0), parameters: Box::new([ParameterId(id % 7), ParameterId(id % 3)]) }
    }

    #[test]
    fn a_draw_from_blocks_is_the_draw_from_a_list() {
        // Neither in order nor once each; the trees 1 and 3 are joined on the way.
        let visits = |i: u32| (TreeId([0, 1, 2, 3, 0][(i * 31 % 5) as usize]), LeafId(i * 387 % 500));
        let mut visited = VisitedLeaves::new(&leaf(0));
        let mut counted: BTreeMap<(LeafId, TreeId), f64> = BTreeMap::new();
        for i in 0..1500 {
            let (tree, id) = visits(i);
            let joined = if i >= 700 && tree.0 == 3 { TreeId(1) } else { tree };
            visited.visit(joined, id, &leaf(id.0));
            *counted.entry((id, if tree.0 == 3 { TreeId(1) } else { tree })).or_default() += 1.0;
            if i == 700 {
                visited.join(TreeId(1), TreeId(3));
            }
        }
        for tree in [0, 1, 2, 9].map(TreeId) {
            for wanted in [vec![], vec![(0, ParameterId(5))], vec![(0, ParameterId(5)), (1, ParameterId(2))]] {
                let agrees = |id: LeafId| wanted.iter().all(|&(row, value)| leaf(id.0).parameters[row] == value);
                let list: Vec<(LeafId, f64)> = counted
                    .iter()
                    .filter(|((id, of), _)| *of != tree && agrees(*id))
                    .map(|((id, _), visits)| (*id, *visits))
                    .collect();
                assert!(!list.is_empty());
                let choices = [visited.reached_by_others(tree).with(wanted.iter().copied()).unwrap()];
                for level in Level::available() {
                    for step in 0..=1000 {
                        let u = f64::from(step) / 1000.0;
                        assert_eq!(draw_by_visits(level, &choices, u), draw(&list, u), "{tree:?} {wanted:?} {u}");
                    }
                }
            }
        }
        assert!(visited.reached_by_others(TreeId(0)).with([(0, ParameterId(99))].into_iter()).is_none());
        assert_eq!(draw_by_visits(Level::scalar(), &[], 0.5), None);
        // 3 and 2 are there, but on no leaf together.
        let mut few = VisitedLeaves::new(&leaf(0));
        [3, 5].iter().for_each(|&id| few.visit(TreeId(0), LeafId(id), &leaf(id)));
        let apart = few.reached_by_others(TreeId(1)).with([(0, ParameterId(3)), (1, ParameterId(2))].into_iter());
        assert_eq!(draw_by_visits(Level::scalar(), &[apart.unwrap()], 0.5), None);
        assert_eq!(draw_by_visits(Level::scalar(), &[few.reached_by_others(TreeId(0))], 0.5), None);
    }

    #[test]
    fn a_tree_with_one_leaf_takes_one_number() {
        let mut visited = VisitedLeaves::new(&leaf(0));
        (0..1000).for_each(|id| visited.visit(TreeId(0), LeafId(id), &leaf(id)));
        visited.visit(TreeId(1), LeafId(900), &leaf(900));
        assert_eq!(visited.by_tree[1].1.visits, [1]);
        assert_eq!(visited.by_tree[1].1.sums, [0, 0, 0, 0, 0, 0, 0, 1]);
    }
}
