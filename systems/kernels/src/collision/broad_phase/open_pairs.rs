//! The state that passes between broad phase and exact queries: open pairs, and lanes that collide with certainty.
//!
//! An `Open` names a pair, or a whole group, and the lanes of a block in which the bounds do not prove it free. `Hits` collects
//! the lanes in which inscribed volumes prove a collision. The types are apart because `block_of_samples`, `along`, the discrete checks and
//! the certifier all use them.

use crate::collision::samples::interval::LANES;
use crate::lanes::vector::F32Row;

/// A pair, and the lanes of a block in which it is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Open {
    /// Number of its group in the pair set.
    pub active: u32,
    /// Index of the pair, or [`ALL`].
    pub pair: u32,
    /// Lane 0 is the lowest bit.
    pub lanes: u16,
}

/// All pairs of the group.
pub(crate) const ALL: u32 = u32::MAX;

/// In which lanes something collides with certainty, and which lanes need no further look for that.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hits {
    /// By lane, where it collides: the pair, and minus how far its insides overlap, metres.
    pub pairs: [(u32, f32); LANES],
    pub colliding: u16,
    /// Lanes that are decided, whether they collide or not.
    pub settled: u16,
    /// Lanes that need not be decided where the one before them collides.
    pub followers: u16,
    /// Whether one collision, in any lane, decides all of them.
    pub one_decides: bool,
}

impl Hits {
    /// A pair collides in these lanes.
    pub(crate) fn add(&mut self, pair: u32, lanes: u16, overlaps: &F32Row) {
        let mut new = lanes & !self.colliding;
        self.colliding |= lanes;
        while new != 0 {
            let lane = new.trailing_zeros();
            new &= new - 1;
            self.pairs[lane as usize] = (pair, overlaps[lane as usize]);
            self.settle(lane);
        }
    }

    /// A lane collides.
    pub(crate) fn settle(&mut self, lane: u32) {
        self.settled |= if self.one_decides { u16::MAX } else { 1 << lane | following(self.followers, lane) };
    }
}

/// The lanes in one row of followers behind a lane.
fn following(followers: u16, lane: u32) -> u16 {
    let behind = u32::from(followers) & (u32::MAX << (lane + 1));
    // What is carried on from the first of them runs up to the first lane that is none.
    let carried = behind.wrapping_add(1 << (lane + 1));
    (behind & !carried) as u16
}

/// All lanes of a block that has this many intervals.
pub(crate) fn all_lanes(intervals: usize) -> u16 {
    u16::MAX >> (LANES - intervals.min(LANES))
}
