//! Where everything is: poses of bodies from configurations.

mod forward;
mod jacobian;
mod lane_forward;
mod lane_jacobian;
mod weighted_points;

pub use forward::{Carriage, Kinematics, Placement};
pub use jacobian::{AttachmentTree, Column, geometric_jacobian};
pub use lane_forward::{LaneKinematics, POSE_ROWS};
pub(crate) use lane_forward::{LaneStep, Parent, run as run_lanes};
pub use lane_jacobian::LaneJacobian;
pub(crate) use lane_jacobian::{At, LaneColumn};
pub use weighted_points::{MomentColumn, PointNode, PointTree, WeightedPoint};
