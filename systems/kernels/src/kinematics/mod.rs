//! Where everything is: poses of bodies from configurations.

pub(crate) mod forward;
pub(crate) mod jacobian;
pub(crate) mod joint_table;
pub(crate) mod lane_forward;
pub(crate) mod lane_jacobian;
pub(crate) mod lane_steps;
pub(crate) mod weighted_points;

pub use crate::kinematics::forward::{Kinematics, Placement, RigidAttachment};
pub use crate::kinematics::jacobian::{AttachmentTree, Column, Standing, geometric_jacobian};
pub use crate::kinematics::lane_forward::LaneKinematics;
pub(crate) use crate::kinematics::lane_jacobian::LaneColumn;
pub use crate::kinematics::lane_jacobian::LaneJacobian;
pub use crate::kinematics::lane_steps::POSE_ROWS;
pub use crate::kinematics::weighted_points::{MomentColumn, PointNode, PointTree, WeightedPoint};
