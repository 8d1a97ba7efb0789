//! Small dense linear algebra on slices that the caller owns; nothing here allocates.

pub(crate) mod lane_ldlt;
pub(crate) mod ldlt;
pub(crate) mod wide_ldlt;

pub use crate::linear::ldlt::{damped_gram, factor, solve, solve_damped};
