//! Robots: the model of one part as its files describe it, and all parts of a problem composed into one kinematic tree.

pub(crate) mod body_centre;
pub(crate) mod compose;
pub mod configuration;
pub(crate) mod error;
pub(crate) mod follower_limits;
pub mod hybrid_robot;
pub mod indices;
pub(crate) mod joined_links;
pub mod joint;
pub(crate) mod limits;
pub mod model;
pub mod shape;

pub use crate::robot::body_centre::CentreSource;
pub use crate::robot::error::{ComposeError, CoordinateError, PartError};
pub use crate::robot::hybrid_robot::{DisabledPair, Gripper, Handle, Link, Part, Robot, Shape, Surface};
pub use crate::robot::indices::{
    GripperIndex, HandleIndex, JointIndex, LinkIndex, PartIndex, ShapeIndex, SurfaceIndex,
};
pub use crate::robot::joined_links::JoinedLinks;
pub use crate::robot::joint::{CoordinateValue, Joint, JointType, PartKind, PartPlacement, RootJoint, Source};
pub use crate::robot::limits::{NarrowedLimits, NoRoom};
