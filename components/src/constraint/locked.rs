//! A joint of one coordinate that keeps its value.

use crate::robot::indices::JointIndex;

/// A joint with its value; radians or metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locked {
    /// A joint with one coordinate of its own.
    pub joint: JointIndex,
    /// Its value.
    pub value: LockedValue,
}

/// Where the value comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LockedValue {
    /// A number that never changes.
    Fixed(f64),
    /// An argument of the solve: the x of the translation of the leaf parameter in that slot.
    Argument(usize),
}
