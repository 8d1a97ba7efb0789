//! One part as its files describe it: links, joints and documents, before it is placed in a world.
//!
//! Readers (URDF, SRDF) and code produce a [`Model`]; nothing here knows a file format.

use crate::Pose;
use crate::robot::shape::geometry::Geometry;
use glam::DVec3;

/// A robot, object or environment as described. Names carry no prefix. Indices refer to `links`.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// The model's own name.
    pub name: String,
    /// Links; exactly one is no joint's child.
    pub links: Vec<LinkModel>,
    /// Joints, in file order.
    pub joints: Vec<JointModel>,
    /// Grippers.
    pub grippers: Vec<GripperModel>,
    /// Handles.
    pub handles: Vec<HandleModel>,
    /// Contact surfaces.
    pub surfaces: Vec<SurfaceModel>,
    /// Pairs of link names whose collisions are disabled, and why.
    pub disabled_pairs: Vec<(String, String, String)>,
    /// Named configurations.
    pub group_states: Vec<GroupState>,
    /// End effectors.
    pub end_effectors: Vec<EndEffectorModel>,
    /// Whether an SRDF was read.
    pub has_srdf: bool,
}

/// A link with its collision shapes.
#[derive(Clone, Debug, Default)]
pub struct LinkModel {
    /// Name, unique in the model.
    pub name: String,
    /// Collision shapes, posed in the link frame.
    pub shapes: Vec<(Pose, Geometry)>,
    /// Mass properties.
    pub inertial: Option<Inertial>,
}

/// Mass and its centre in the link frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertial {
    /// Kilograms.
    pub mass: f64,
    /// Centre of mass in the link frame, metres.
    pub center: DVec3,
}

/// What a joint lets move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Nothing.
    Fixed,
    /// Rotation within limits.
    Revolute,
    /// Rotation without limits; one unwrapped angle.
    Continuous,
    /// Translation.
    Prismatic,
    /// x, y, θ in the plane normal to the axis.
    Planar,
    /// Everything.
    Floating,
}

/// A joint between two links.
#[derive(Clone, Debug)]
pub struct JointModel {
    /// Name, unique in the model.
    pub name: String,
    /// What it lets move.
    pub kind: JointKind,
    /// Index of the parent link.
    pub parent: usize,
    /// Index of the child link; its frame is the joint frame.
    pub child: usize,
    /// Pose of the joint frame at zero in the parent link.
    pub parent_from_joint: Pose,
    /// Unit axis in the joint frame; ignored for fixed and floating joints.
    pub axis: DVec3,
    /// Limits for revolute and prismatic joints, rad or m; (−∞, ∞) otherwise.
    pub limits: (f64, f64),
    /// Velocity limit, rad/s or m/s, where the file gives one.
    pub velocity_limit: Option<f64>,
    /// URDF `mimic`: (leader joint's name, multiplier, offset).
    pub mimic: Option<(String, f64, f64)>,
}

/// A gripper in its link.
#[derive(Clone, Debug)]
pub struct GripperModel {
    /// Name.
    pub name: String,
    /// Name of the link.
    pub link: String,
    /// Pose of the gripper frame in the link.
    pub link_from_gripper: Pose,
    /// Stand-off, metres.
    pub clearance: f64,
}

/// A handle in its link.
#[derive(Clone, Debug)]
pub struct HandleModel {
    /// Name.
    pub name: String,
    /// Name of the link.
    pub link: String,
    /// Pose of the handle frame in the link.
    pub link_from_handle: Pose,
    /// Stand-off, metres.
    pub clearance: f64,
    /// Rows (tx ty tz rx ry rz) that a grasp forces to zero.
    pub mask: [bool; 6],
    /// Rows that are frozen while held; by default the complement of `mask`.
    pub mask_complement: [bool; 6],
    /// Approach direction; (1, 0, 0) by default.
    pub approaching_direction: DVec3,
}

/// Contact polygons on a link.
#[derive(Clone, Debug)]
pub struct SurfaceModel {
    /// Name.
    pub name: String,
    /// Name of the link.
    pub link: String,
    /// Vertices in the link frame, metres.
    pub points: Vec<DVec3>,
    /// Convex planar polygons, counter-clockwise seen from outside.
    pub polygons: Vec<Vec<u32>>,
}

/// A named configuration of some joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroupState {
    /// Its name.
    pub name: String,
    /// Joint names and values.
    pub values: Vec<(String, f64)>,
    /// The message where the description contradicts itself in a joint: no robot can be in this configuration.
    pub contradiction: Option<String>,
}

/// An end effector as configuration tools name it: which links are a hand, and where it is mounted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EndEffectorModel {
    /// Its name.
    pub name: String,
    /// Name of the link that carries it.
    pub parent_link: String,
    /// Names of the links of its group, in the order of the file.
    pub links: Vec<String>,
}
