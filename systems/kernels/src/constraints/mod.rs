//! TODO(page): what lies in constraints.

pub mod centre_of_mass;
pub mod com_between;
pub mod custom;
pub mod distance;
pub(crate) mod evaluation;
pub mod locked;
pub mod placement;
pub mod relative_pose;
pub mod rows_out;

pub use crate::constraints::evaluation::{parameter, residual};
pub use crate::constraints::rows_out::{RowsOut, placement_of};
