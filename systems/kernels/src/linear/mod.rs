//! Small dense linear algebra on slices that the caller owns; nothing here allocates.

mod ldlt;

pub use ldlt::{damped_gram, factor, solve, solve_damped};
