//! Ranges of leaders that the limits of their followers make smaller.

use crate::robot::indices::JointIndex;
use std::fmt;

/// Values that differ by less than this, radians or metres, are one: limits in files are rounded.
pub(crate) const SAME: f64 = 1e-9;

/// A leader whose range its followers make smaller.
#[derive(Clone, Debug, PartialEq)]
pub struct NarrowedLimits {
    /// The leader.
    pub leader: JointIndex,
    /// The followers whose limits end its range.
    pub followers: Vec<JointIndex>,
    /// Its own limits, radians or metres.
    pub own: (f64, f64),
    /// What is left of them.
    pub left: (f64, f64),
}

impl NarrowedLimits {
    /// Whether so little is left that something is likely wrong with the model: one value, or less than half of the range.
    #[must_use]
    pub fn is_suspicious(&self) -> bool {
        let width = |(low, high): (f64, f64)| high - low;
        width(self.left) <= SAME || width(self.left) < 0.5 * width(self.own)
    }
}

/// A leader that has no value at which all its followers keep their limits. Names are without the part's.
#[derive(Clone, Debug, PartialEq)]
pub struct NoRoom {
    /// The leader.
    pub leader: String,
    /// What its limits and those of the followers before leave it.
    pub range: (f64, f64),
    /// The follower that leaves nothing of it.
    pub follower: String,
    /// The follower's own limits.
    pub follower_range: (f64, f64),
    /// The leader's values at which the follower keeps them.
    pub allowed: (f64, f64),
}

impl fmt::Display for NoRoom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { leader, range, follower, follower_range, allowed } = self;
        write!(
            f,
            "joint `{follower}` follows `{leader}`, which moves in [{}, {}]; to keep its own limits [{}, {}] it needs \
             `{leader}` in [{}, {}]: there is no such value",
            range.0, range.1, follower_range.0, follower_range.1, allowed.0, allowed.1
        )
    }
}
