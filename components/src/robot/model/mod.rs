//! One part as its files describe it, before it is composed with others into a robot: what it is, and its tree of links and joints.

pub(crate) mod part_model;
pub(crate) mod tree;

pub use crate::robot::model::part_model::{
    EndEffectorModel, GripperModel, GroupState, HandleModel, Inertial, JointKind, JointModel, LinkModel, Model,
    SurfaceModel,
};
