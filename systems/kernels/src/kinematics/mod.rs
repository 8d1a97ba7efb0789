//! Where everything is: poses of bodies from configurations, and how fast they move.
//!
//! `joint_table` says how each joint is mounted and which coordinates move it. `attachment_tree` says what each body is attached to.
//! `forward` is the scalar loop over the table, `lane_forward` the loop in lanes, with steps made by `lane_steps`. `jacobian`
//! finds columns along the tree, `lane_jacobian` evaluates them in lanes, `weighted_points` those of centres of mass.

pub(crate) mod attachment_tree;
pub(crate) mod forward;
pub(crate) mod jacobian;
pub(crate) mod joint_table;
pub(crate) mod lane_forward;
pub(crate) mod lane_jacobian;
pub(crate) mod lane_steps;
pub(crate) mod weighted_points;

pub use crate::kinematics::attachment_tree::{AttachmentTree, Standing};
pub use crate::kinematics::forward::{Kinematics, Placement, RigidAttachment};
pub use crate::kinematics::jacobian::{Column, geometric_jacobian};
pub use crate::kinematics::lane_forward::LaneKinematics;
pub(crate) use crate::kinematics::lane_jacobian::LaneColumn;
pub use crate::kinematics::lane_jacobian::LaneJacobian;
pub use crate::kinematics::lane_steps::POSE_ROWS;
pub use crate::kinematics::weighted_points::{MomentColumn, PointNode, PointTree, WeightedPoint};
