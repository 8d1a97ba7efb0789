//! Small dense linear algebra on slices that the caller owns; nothing here allocates.

mod lane_ldlt;
mod ldlt;
mod wide_ldlt;

pub(crate) use lane_ldlt::{LaneSystem, Rows, damped_step_lanes};
pub use ldlt::{damped_gram, factor, solve, solve_damped};
pub(crate) use wide_ldlt::{MOST_WIDE, WideMemory, solve_damped_wide};
