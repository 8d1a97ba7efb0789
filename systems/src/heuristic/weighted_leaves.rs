//! The leaves of one state that a tree has reached, with the weights by which they are drawn: kept in blocks, so that a
//! new leaf or a changed weight costs one block and a draw goes from block to block.

use foliate_components::graph::StateId;
use foliate_components::graph::leaf::LeafId;

/// Leaves per block.
const BLOCK: usize = 64;
/// A leaf one change of grasp farther is so many times less likely to be chosen.
pub(crate) const FOCUS: f64 = 2.0;
/// A leaf loses half of its weight in so many tries, so that what leads nowhere is left alone.
const LEAF_PATIENCE: f64 = 8.0;
/// Likewise a state.
const STATE_PATIENCE: f64 = 64.0;

/// Leaves of one state, by id.
#[derive(Clone, Debug)]
pub(crate) struct WeightedLeaves {
    pub state: StateId,
    leaves: Vec<Weighted>,
    /// By leaf, for sums: a power and a division each.
    weights: Vec<f64>,
    blocks: Vec<Block>,
}

/// A leaf, how far it is from what other trees have reached, and how many candidates have started there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weighted {
    pub leaf: LeafId,
    pub far: u16,
    /// What stands in the way adds so many changes of grasp.
    pub detours: u16,
    pub tries: u32,
    /// Whether no way leads there any more: it is not chosen.
    pub lost: bool,
}

#[derive(Clone, Copy, Debug)]
struct Block {
    weight: f64,
    near: u16,
    tries: u64,
}

impl Weighted {
    fn weight(&self) -> f64 {
        if self.lost {
            0.0
        } else {
            FOCUS.powi(-i32::from(self.far.saturating_add(self.detours).min(i16::MAX as u16) as i16))
                / (1.0 + f64::from(self.tries) / LEAF_PATIENCE)
        }
    }
}

impl WeightedLeaves {
    /// Leaves of a state, sorted by id.
    pub fn new(state: StateId, leaves: Vec<Weighted>) -> Self {
        let weights = leaves.iter().map(Weighted::weight).collect();
        let mut weighted = Self { state, leaves, weights, blocks: Vec::new() };
        weighted.sum_from(0);
        weighted
    }

    /// A leaf's entry.
    pub fn get(&self, leaf: LeafId) -> Option<&Weighted> {
        self.leaves.binary_search_by_key(&leaf, |w| w.leaf).ok().map(|at| &self.leaves[at])
    }

    /// Adds a leaf, unless it is here.
    pub fn insert(&mut self, new: Weighted) {
        if let Err(at) = self.leaves.binary_search_by_key(&new.leaf, |w| w.leaf) {
            self.leaves.insert(at, new);
            self.weights.insert(at, new.weight());
            self.sum_from(at / BLOCK);
        }
    }

    /// Changes a leaf's entry, where it is here.
    pub fn change(&mut self, leaf: LeafId, change: impl FnOnce(&mut Weighted)) {
        if let Ok(at) = self.leaves.binary_search_by_key(&leaf, |w| w.leaf) {
            change(&mut self.leaves[at]);
            self.weights[at] = self.leaves[at].weight();
            self.blocks[at / BLOCK] = self.block(at / BLOCK);
        }
    }

    /// The weight of the state: by its nearest leaf, and less with every try.
    pub fn weight(&self) -> f64 {
        let near = self.blocks.iter().map(|b| b.near).min().unwrap_or(u16::MAX);
        let tries: u64 = self.blocks.iter().map(|b| b.tries).sum();
        FOCUS.powi(-i32::from(near)) / (1.0 + tries as f64 / STATE_PATIENCE)
    }

    /// The leaf that is most likely to be chosen, with its weight; of equals the first.
    pub fn heaviest(&self) -> Option<(f64, &Weighted)> {
        let heavier = |most: usize, at: usize| if self.weights[at] > self.weights[most] { at } else { most };
        let at = (0..self.weights.len()).reduce(heavier)?;
        (self.weights[at] > 0.0).then(|| (self.weights[at], &self.leaves[at]))
    }

    /// Draws a leaf by `u` ∈ [0, 1).
    pub fn draw(&self, u: f64) -> Option<LeafId> {
        let mut left = u * self.blocks.iter().map(|b| b.weight).sum::<f64>();
        // Rounding may leave a rest behind the last one.
        let last = self.blocks.iter().rposition(|b| b.weight > 0.0)?;
        let within = |(index, block): (usize, &Block)| {
            let is_here = left < block.weight || index == last;
            if !is_here {
                left -= block.weight;
            }
            is_here.then_some(index)
        };
        let start = BLOCK * self.blocks.iter().enumerate().find_map(within)?;
        let weights = &self.weights[start..self.weights.len().min(start + BLOCK)];
        let drawn = weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        });
        let drawn = drawn.or_else(|| weights.iter().rposition(|&weight| weight > 0.0))?;
        Some(self.leaves[start + drawn].leaf)
    }

    fn sum_from(&mut self, first: usize) {
        self.blocks.truncate(first);
        for number in first..self.leaves.len().div_ceil(BLOCK) {
            self.blocks.push(self.block(number));
        }
    }

    /// Sums of a block.
    fn block(&self, number: usize) -> Block {
        let range = number * BLOCK..self.leaves.len().min((number + 1) * BLOCK);
        let leaves = &self.leaves[range.clone()];
        Block {
            weight: self.weights[range].iter().sum(),
            near: leaves.iter().filter(|w| !w.lost).map(|w| w.far.saturating_add(w.detours)).min().unwrap_or(u16::MAX),
            tries: leaves.iter().map(|w| u64::from(w.tries)).sum(),
        }
    }
}

/// The leaves of one state, of states that are sorted.
pub(crate) fn in_state(states: &mut [WeightedLeaves], state: StateId) -> Option<&mut WeightedLeaves> {
    let at = states.binary_search_by_key(&state, |s| s.state).ok()?;
    Some(&mut states[at])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::random::draw;

    #[test]
    fn a_draw_from_blocks_is_the_draw_from_the_list() {
        let entry = |leaf: u32| Weighted {
            leaf: LeafId(leaf),
            far: (leaf * 7 % 5) as u16,
            detours: (leaf * 3 % 2) as u16,
            tries: leaf * 13 % 17,
            lost: leaf % 11 == 3,
        };
        let mut kept = WeightedLeaves::new(StateId(0), Vec::new());
        // Neither in order nor once each.
        for leaf in (0..1000).map(|i| i * 387 % 500) {
            kept.insert(entry(leaf));
        }
        kept.change(LeafId(77), |w| w.far = 0);
        kept.change(LeafId(1000), |w| w.far = 0);
        let list: Vec<Weighted> =
            (0..500).map(entry).map(|w| Weighted { far: if w.leaf.0 == 77 { 0 } else { w.far }, ..w }).collect();
        let choices: Vec<(LeafId, f64)> = list.iter().map(|w| (w.leaf, w.weight())).collect();
        for step in 0..=1000 {
            let u = f64::from(step) / 1000.0;
            assert_eq!(kept.draw(u), draw(&choices, u), "{u}");
        }
        let afresh = WeightedLeaves::new(StateId(0), list);
        assert_eq!(afresh.weight().to_bits(), kept.weight().to_bits());
    }
}
