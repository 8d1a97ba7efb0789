//! Curves over time: every coordinate is a cubic polynomial between two knots.
//!
//! `cubic` is one polynomial and its extremes in closed form. `hermite` is a whole curve through knots and velocities, and its
//! position limits. `turning` bounds how fast a quaternion turns whose numbers are cubics. Collision and residuals use all three.

pub mod cubic;
pub mod hermite;
pub(crate) mod turning;

pub use crate::curve::cubic::Cubic;
pub use crate::curve::hermite::{HermiteCurve, LimitExceeded};
