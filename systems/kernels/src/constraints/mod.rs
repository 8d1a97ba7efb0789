//! Values and Jacobians of constraints, one file per kind.
//!
//! Every function takes the poses of bodies in the world and writes rows; which velocity coordinates matter is compiled
//! beforehand into [`Column`](crate::kinematics::jacobian::Column)s. Rows are metres and radians.
//!
//! `rows_out` defines where rows are written and the helpers that all kinds share; every kind depends on it and on no other
//! kind. `resting` says for placements whether an object is over its support as it must be. `evaluation` builds on all kinds: it evaluates any constraint on its own.

pub mod centre_of_mass;
pub mod com_between;
pub mod custom;
pub mod distance;
pub(crate) mod evaluation;
pub mod locked;
pub mod placement;
pub mod relative_pose;
pub mod resting;
pub mod rows_out;

pub use crate::constraints::evaluation::{parameter, residual};
pub use crate::constraints::rows_out::{RowsOut, placement_of};
