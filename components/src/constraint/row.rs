//! What one row of a constraint asks for.

use super::Mask;
use crate::Pose;
use crate::pose::{exp_so3, log_so3};
use glam::DVec3;

/// What a row asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Row {
    /// The row is zero.
    Zero,
    /// The row equals a parameter (a right-hand side): its level sets are the leaves of a foliation (P0 eq. 1).
    Parameter,
    /// The row is not negative.
    Inequality,
}

/// The six rows of a relative pose; `None` where it is free.
pub type Rows = [Option<Row>; 6];

/// Rows that are zero where `zero` is set, parameters where only `parameter` is set, free elsewhere.
#[must_use]
pub fn rows(zero: Mask, parameter: Mask) -> Rows {
    std::array::from_fn(|i| match (zero.0[i], parameter.0[i]) {
        (true, _) => Some(Row::Zero),
        (false, true) => Some(Row::Parameter),
        (false, false) => None,
    })
}

/// Keeps of a relative pose what the parameter rows say, and nothing else: other translations and other components of the
/// rotation vector become zero. Two configurations lie on the same leaf where this is the same pose.
#[must_use]
pub fn parameter_of(rows: &Rows, pose: &Pose) -> Pose {
    let kept = |i: usize| rows[i] == Some(Row::Parameter);
    let mut translation = DVec3::ZERO;
    (0..3).filter(|&i| kept(i)).for_each(|i| translation[i] = pose.translation[i]);
    if (3..6).all(kept) {
        // The round trip through the rotation vector would cost the last bits.
        return Pose::from_parts(translation, pose.rotation);
    }
    let turn = log_so3(pose.rotation);
    let mut left = DVec3::ZERO;
    (0..3).filter(|&i| kept(i + 3)).for_each(|i| left[i] = turn[i]);
    Pose::from_parts(translation, exp_so3(left))
}
