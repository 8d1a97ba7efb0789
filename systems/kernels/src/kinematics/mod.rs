//! Where everything is: poses of bodies from configurations.

mod forward;
mod jacobian;
mod weighted_points;

pub use forward::{Carriage, Kinematics, Placement};
pub use jacobian::{AttachmentTree, Column, Standing, geometric_jacobian};
pub use weighted_points::{MomentColumn, PointNode, PointTree, WeightedPoint};
