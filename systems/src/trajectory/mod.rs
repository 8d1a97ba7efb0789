//! From a path without times to a trajectory: smooth, timed, and certified as the curve that it is.
//!
//! The robot stops where the leaf changes. What lies between two stops is a `stretch`, and with what smoothing asks a `smoothing_problem`.
//! `smoothing` replaces its corners by arcs, or lays a spline through dense knots whose corners `rounding` has rounded. `timing` finds the
//! fastest motion along it (objects in a hand not too fast: `held_speed`) and writes its `rows`. `timed_path` puts stretches together, has the curve
//! certified, and makes a stretch anew that is refused.

pub(crate) mod held_speed;
pub(crate) mod rounding;
pub(crate) mod rows;
pub(crate) mod smoothing;
pub(crate) mod smoothing_problem;
pub(crate) mod stretch;
pub mod timed_path;
pub(crate) mod timing;

pub use crate::trajectory::timed_path::{TimedPathError, timed_path};
pub use crate::trajectory::timing::StretchError;
