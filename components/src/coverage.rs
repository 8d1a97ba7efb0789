//! Which pairs of collision shapes a proof tests, and why it leaves out the others.

use crate::robot::indices::ShapeIndex;

/// Why a pair of shapes is not tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LeftOut {
    /// Both are on one link, or on links that fixed joints of the model make one body.
    SameBody,
    /// Both are fixed in the world.
    Environment,
    /// An SRDF disables the pair.
    Srdf,
    /// One joint joins the two links, and they touch wherever it is.
    Adjacent,
    /// The problem ignores the pair.
    Ignored,
}

impl LeftOut {
    /// The reason in words.
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Self::SameBody => "one rigid body",
            Self::Environment => "both fixed in the world",
            Self::Srdf => "disabled by the SRDF",
            Self::Adjacent => "adjacent",
            Self::Ignored => "ignored by the scene",
        }
    }

    /// Whether a file or the problem decided it, so that the two may collide nevertheless.
    #[must_use]
    pub fn is_a_decision(self) -> bool {
        matches!(self, Self::Srdf | Self::Adjacent | Self::Ignored)
    }
}

/// A pair of shapes that is not tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOutPair {
    /// One shape.
    pub first: ShapeIndex,
    /// The other.
    pub second: ShapeIndex,
    /// Why.
    pub why: LeftOut,
}

/// How many pairs of collision shapes are tested, and how many are left out, by reason. Every pair of shapes is counted in one of the
/// first seven.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PairCounts {
    /// Tested along motions.
    pub tested: u64,
    /// Held together by locked joints alone: tested once, at the start.
    pub rigid: u64,
    /// Not tested: see [`LeftOut::SameBody`].
    pub same_body: u64,
    /// Not tested: see [`LeftOut::Environment`].
    pub environment: u64,
    /// Not tested: see [`LeftOut::Srdf`].
    pub srdf: u64,
    /// Not tested: see [`LeftOut::Adjacent`].
    pub adjacent: u64,
    /// Not tested: see [`LeftOut::Ignored`].
    pub ignored: u64,
    /// Of the tested, those whose margin does not count somewhere on the path, since one is grasped by the other there.
    pub grasped: u64,
    /// Likewise, since one is placed on the other.
    pub placed: u64,
}

impl PairCounts {
    /// Counts a pair that is left out.
    pub fn leave_out(&mut self, why: LeftOut, pairs: u64) {
        match why {
            LeftOut::SameBody => self.same_body += pairs,
            LeftOut::Environment => self.environment += pairs,
            LeftOut::Srdf => self.srdf += pairs,
            LeftOut::Adjacent => self.adjacent += pairs,
            LeftOut::Ignored => self.ignored += pairs,
        }
    }

    /// Pairs that are tested at all.
    #[must_use]
    pub fn looked_at(&self) -> u64 {
        self.tested + self.rigid
    }

    /// Pairs that a file or the problem excludes from the test.
    #[must_use]
    pub fn decided(&self) -> u64 {
        self.srdf + self.adjacent + self.ignored
    }
}
