//! Two points at a distance, or no nearer or no farther than that.

use super::{Frame, Row};

/// The distance between the origins of two frames. The row is `|p_B − p_A| − length`, times −1 where `at_most`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// One point.
    pub a: Frame,
    /// The other.
    pub b: Frame,
    /// Metres, positive.
    pub length: f64,
    /// [`Row::Zero`], or [`Row::Inequality`] for "at least" (with `at_most`: "at most").
    pub row: Row,
    /// Which side of an inequality is allowed.
    pub at_most: bool,
}
