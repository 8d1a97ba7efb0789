//! How a block of intervals is cut into shorter ones, and how far a clearance certifies neighbouring intervals.
//!
//! `Parts` halves all intervals of a block as often as the lanes allow. `reached` extends the clearance of one lane to the
//! intervals next to it. Both work on intervals alone and know neither scene nor pairs; only the certifier uses them.

use crate::collision::samples::interval::{Interval, LANES};

/// The lanes to either side of one that are certified by what is left of its clearance at its ends: the intervals between
/// take twice, once to their samples and once beyond, what they can bring the pair closer. Also what is left after the
/// last of them.
pub(crate) fn reached(intervals: &[Interval], lane: usize, left: f64, closer: impl Fn(usize) -> f64) -> (u16, f64) {
    let (mut lanes, mut least) = (0, left);
    let mut go = |next: &mut dyn FnMut(usize) -> Option<usize>| {
        let (mut at, mut left) = (lane, left);
        while let Some(other) = next(at) {
            left -= 2.0 * closer(other);
            if left.is_nan() || left < 0.0 {
                break;
            }
            lanes |= 1 << other;
            least = least.min(left);
            at = other;
        }
    };
    go(&mut |at| (at + 1 < intervals.len() && intervals[at].is_followed_by(intervals[at + 1])).then_some(at + 1));
    go(&mut |at| (at > 0 && intervals[at - 1].is_followed_by(intervals[at])).then(|| at - 1));
    (lanes, least)
}

/// Intervals of a block, each with the lane that its parent had.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts {
    parts: [(Interval, usize); LANES],
    pub(crate) count: usize,
}

impl Default for Parts {
    fn default() -> Self {
        Self { parts: [(Interval::whole(0), 0); LANES], count: 0 }
    }
}

impl Parts {
    pub(crate) fn push(&mut self, part: (Interval, usize)) {
        self.parts[self.count] = part;
        self.count += 1;
    }

    pub(crate) fn iter(&self) -> std::slice::Iter<'_, (Interval, usize)> {
        self.parts[..self.count].iter()
    }

    /// Halves intervals, all of them at a time, as often as lanes allow; those that are as short as they get stay.
    pub(crate) fn cut_up(&mut self) {
        while 2 * self.count <= LANES && self.iter().any(|(i, _)| i.halves().is_some()) {
            let whole = std::mem::take(self);
            for &(interval, parent) in whole.iter() {
                match interval.halves() {
                    Some(halves) => halves.into_iter().for_each(|half| self.push((half, parent))),
                    None => self.push((interval, parent)),
                }
            }
        }
    }
}
