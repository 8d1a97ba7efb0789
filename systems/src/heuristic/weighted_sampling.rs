//! Draws among leaves that many trees have reached, near ones first.

use crate::exploration::reached_leaves::LeafParameterColumns;
use foliate_components::graph::leaf::LeafId;
use foliate_kernels::lanes::{Isa, Kernel, Level};

/// A leaf that is so many changes of grasp farther than the nearest is as good as never drawn.
const MOST_BEHIND: u16 = 20;

/// Distances that are weighed at once.
const CHUNK: usize = 32;

/// What a tree has reached while it had its own id.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reached<'a> {
    /// In order of first visit.
    pub leaves: &'a [LeafId],
    /// The same by state.
    pub columns: &'a [LeafParameterColumns],
}

/// Draws by `u` ∈ [0, 1) a leaf of some trees, each with weight [`FOCUS`](crate::heuristic::weighted_leaves::FOCUS)⁻²ᵈ of
/// its distance d: in order of tree and first visit, while distances come state by state. `nearest` is the smallest of them.
/// Sums of whole numbers: no rounding, and
/// additions that need not wait for each other.
pub(crate) fn draw_weighted(
    level: Level,
    trees: &[Reached<'_>],
    (far, nearest): (&[u16], u16),
    u: f64,
    sums: &mut Vec<u64>,
) -> Option<LeafId> {
    sums.clear();
    level.run(BlockSums { trees, far, nearest, sums });
    let sum: u64 = sums.iter().sum();
    // Rounding must not lead behind the last one.
    let mut left = ((u * sum as f64) as u64).min(sum.checked_sub(1)?);
    let mut is_here = |weight: u64| {
        let is_here = left < weight;
        left -= if is_here { 0 } else { weight };
        is_here
    };
    let mut block = sums.iter().position(|&sum| is_here(sum))?;
    let mut far = far;
    for tree in trees {
        let blocks = blocks(tree.leaves.len());
        if block < blocks {
            let start = block * LeafParameterColumns::BLOCK;
            let of_block = in_order(tree.columns, far, block);
            let at = of_block.iter().position(|&d| is_here(weight(d, nearest)))?;
            return tree.leaves.get(start + at).copied();
        }
        block -= blocks;
        far = &far[tree.leaves.len()..];
    }
    None
}

fn blocks(leaves: usize) -> usize {
    leaves.div_ceil(LeafParameterColumns::BLOCK)
}

/// Distances of a block of leaves in order of first visit.
fn in_order(columns: &[LeafParameterColumns], mut far: &[u16], block: usize) -> [u16; LeafParameterColumns::BLOCK] {
    let mut ordered = [u16::MAX; LeafParameterColumns::BLOCK];
    for columns in columns {
        let range = columns.block(block);
        for (&place, &far) in columns.places[range.clone()].iter().zip(&far[range]) {
            ordered[place as usize % LeafParameterColumns::BLOCK] = far;
        }
        far = &far[columns.len()..];
    }
    ordered
}

#[inline(always)]
fn weight(far: u16, nearest: u16) -> u64 {
    let behind = u64::from(far - nearest);
    let most = u64::from(MOST_BEHIND);
    // No branch, so that many are weighed at once.
    let weight = 1_u64 << (2 * (most - behind.min(most)));
    if behind <= most { weight } else { 0 }
}

/// Sums of the weights of blocks of every tree's leaves.
struct BlockSums<'a> {
    trees: &'a [Reached<'a>],
    far: &'a [u16],
    nearest: u16,
    sums: &'a mut Vec<u64>,
}

impl Kernel for BlockSums<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, _: I) {
        let mut far = self.far;
        for tree in self.trees {
            let first = self.sums.len();
            self.sums.resize(first + blocks(tree.leaves.len()), 0);
            for columns in tree.columns {
                let (of_state, rest) = far.split_at(columns.len());
                for (block, sum) in self.sums[first..].iter_mut().enumerate() {
                    *sum += sum_of(&of_state[columns.block(block)], self.nearest);
                }
                far = rest;
            }
        }
    }
}

#[inline(always)]
fn sum_of(far: &[u16], nearest: u16) -> u64 {
    let (chunks, rest) = far.as_chunks::<CHUNK>();
    // What is not there weighs nothing.
    let mut last = [u16::MAX; CHUNK];
    last[..rest.len()].copy_from_slice(rest);
    let mut sums = [0; CHUNK];
    for chunk in chunks {
        for index in 0..CHUNK {
            sums[index] += weight(chunk[index], nearest);
        }
    }
    let mut sum = 0;
    for index in 0..CHUNK {
        sum += sums[index] + weight(last[index], nearest);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exploration::reached_leaves::ReachedLeaves;
    use crate::heuristic::weighted_leaves::FOCUS;
    use crate::runtime::random::draw;
    use foliate_components::graph::StateId;
    use foliate_components::graph::leaf::{Leaf, ParameterId};
    use foliate_components::roadmap::TreeId;

    #[test]
    fn near_leaves_are_drawn_as_often_as_their_weights_say() {
        let far_of = |leaf: LeafId| (3 + leaf.0 * 7 % 4 + if leaf.0 % 100 == 50 { 60 } else { 0 }) as u16;
        // Two trees; states come in no order.
        let mut reached = ReachedLeaves::default();
        let born = [TreeId(0), TreeId(1)];
        for id in 0..3000 {
            let leaf = Leaf { state: StateId(id * 13 % 5), parameters: Box::new([ParameterId(id)]) };
            reached.visit(born[(id % 3 == 0) as usize], born[(id % 3 == 0) as usize], LeafId(id), &leaf);
        }
        let trees =
            born.map(|born| Reached { leaves: &reached.by_born_tree[born.at()], columns: reached.columns_of(born) });
        let by_state = |tree: &Reached<'_>| -> Vec<u16> {
            let places = tree.columns.iter().flat_map(|columns| &columns.places);
            places.map(|&place| far_of(tree.leaves[place as usize])).collect()
        };
        let far: Vec<u16> = trees.iter().flat_map(by_state).collect();
        let leaves = trees.iter().flat_map(|tree| tree.leaves);
        let choices: Vec<(LeafId, f64)> =
            leaves.map(|&leaf| (leaf, FOCUS.powi(-2 * i32::from(far_of(leaf))))).collect();
        for level in Level::available() {
            let mut sums = Vec::new();
            for step in 0..1000 {
                let u = f64::from(step) / 1000.0 + 1e-4;
                assert_eq!(draw_weighted(level, &trees, (&far, 3), u, &mut sums), draw(&choices, u), "{u}");
            }
            let last = draw_weighted(level, &trees, (&far, 3), 1.0, &mut sums);
            assert_eq!(last, trees[1].leaves.iter().rfind(|&&leaf| far_of(leaf) < 24).copied());
            assert_eq!(draw_weighted(level, &[], (&[], u16::MAX), 0.5, &mut sums), None);
        }
    }
}
