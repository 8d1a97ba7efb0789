//! The kinematic tree of a page, and what its links look like.

use crate::view::document::{Offset, PoseRow};
use serde::Serialize;

/// Triangles, stored once for all links that show them. Positions are 16-bit numbers between two corners: 0 is `min`, 65535 is `max`.
#[derive(Clone, Debug, Serialize)]
pub struct MeshEntry {
    /// As the model names the file.
    pub name: String,
    /// How many vertices.
    pub vertices: usize,
    /// How many triangles.
    pub triangles: usize,
    /// Least corner, metres.
    pub min: [f64; 3],
    /// Greatest corner, metres.
    pub max: [f64; 3],
    /// `vertices` × 3 unsigned 16-bit numbers.
    pub positions: Offset,
    /// `triangles` × 3 vertex numbers, counter-clockwise seen from outside: 32-bit where `wide`, else 16-bit.
    pub indices: Offset,
    /// Whether vertex numbers have 32 bits.
    pub wide: bool,
    /// How many triangles the file has.
    pub of: usize,
    /// How far the file's surface is from the shown one, metres, measured at the file's vertices; rounding of positions included.
    pub deviation: f64,
}

/// A solid in its own frame, z along the axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ShapeEntry {
    /// Number of a mesh.
    Mesh(usize),
    /// Whole sides.
    Box([f64; 3]),
    /// Radius.
    Sphere(f64),
    /// Radius and length.
    Cylinder([f64; 2]),
    /// Radius and the length of its axis, without the round ends.
    Capsule([f64; 2]),
}

/// A shape on a link.
#[derive(Clone, Debug, Serialize)]
pub struct PlacedShapeEntry {
    /// The solid.
    pub shape: ShapeEntry,
    /// `link_from_shape`.
    pub pose: PoseRow,
    /// Red, green, blue, opacity from 0 to 1 as screens show them, where the model gives them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<[f64; 4]>,
    /// The file that could not be read; the shape is a small box in its place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

/// A rigid link.
#[derive(Clone, Debug, Serialize)]
pub struct LinkEntry {
    /// `part/link`.
    pub name: String,
    /// Number of the part.
    pub part: usize,
    /// Number of the moving joint whose body it is part of; none where it is fixed in the world.
    pub joint: Option<usize>,
    /// Its pose in that joint's frame, or in the world.
    pub joint_from_link: PoseRow,
    /// What it looks like, where the model says that: else it is shown by what is tested.
    pub visual: Vec<PlacedShapeEntry>,
    /// What is tested for collision.
    pub collision: Vec<PlacedShapeEntry>,
}

/// A robot, an object, an environment.
#[derive(Clone, Debug, Serialize)]
pub struct PartEntry {
    /// Its name.
    pub name: String,
    /// `robot`, `object` or `environment`.
    pub kind: &'static str,
}

/// A joint that moves.
///
/// The pose of its body in the parent's body, or in the world, is `parent_from_joint` times the motion: a turn about `axis`, a shift along it,
/// x, y, θ in the xy plane, or a pose. The number of a follower is `multiplier` times the leader's, plus `offset`.
#[derive(Clone, Debug, Serialize)]
pub struct JointEntry {
    /// `part/joint`.
    pub name: String,
    /// Number of the part.
    pub part: usize,
    /// Number of the joint whose body carries it; none where that is the world.
    pub parent: Option<usize>,
    /// Its frame at zero.
    pub parent_from_joint: PoseRow,
    /// `revolute`, `prismatic`, `planar` (x, y, θ) or `freeflyer` (x, y, z, qx, qy, qz, qw).
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Unit axis of a revolute or prismatic joint, in the joint's frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
    /// Its first number in a configuration; none for a follower.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub q: Option<usize>,
    /// Its first number in a velocity; none for a follower. Of a free-flyer the translation in the joint's frame, then the rotation in the
    /// moving one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub v: Option<usize>,
    /// Number of the joint that it follows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leader: Option<usize>,
    /// Of a follower.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiplier: Option<f64>,
    /// Of a follower, radians or metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset: Option<f64>,
    /// Lower bounds, one per number; none where there is none.
    pub lower: Vec<Option<f64>>,
    /// Upper bounds.
    pub upper: Vec<Option<f64>>,
    /// Velocity limit, rad/s or m/s.
    pub velocity: Option<f64>,
}

/// Grippers, handles and surfaces.
#[derive(Clone, Debug, Default, Serialize)]
pub struct DocumentsEntry {
    /// Grippers.
    pub grippers: Vec<FrameEntry>,
    /// Handles.
    pub handles: Vec<HandleEntry>,
    /// Contact surfaces.
    pub surfaces: Vec<SurfaceEntry>,
}

/// A frame on a link.
#[derive(Clone, Debug, Serialize)]
pub struct FrameEntry {
    /// `part/name`.
    pub name: String,
    /// Number of the link.
    pub link: usize,
    /// `link_from_frame`.
    pub pose: PoseRow,
}

/// A handle.
#[derive(Clone, Debug, Serialize)]
pub struct HandleEntry {
    /// `part/handle`.
    pub name: String,
    /// Number of the link.
    pub link: usize,
    /// `link_from_handle`.
    pub pose: PoseRow,
    /// The direction in which a gripper comes, in the handle's frame; none where it is not known: path files do not carry it.
    pub approach: Option<[f64; 3]>,
    /// Which of tx ty tz rx ry rz of the handle in the gripper a grasp makes zero.
    pub mask: [bool; 6],
}

/// A contact polygon.
#[derive(Clone, Debug, Serialize)]
pub struct SurfaceEntry {
    /// `part/surface`.
    pub name: String,
    /// Number of the link.
    pub link: usize,
    /// `contact` of an object, `support` of what carries objects.
    pub kind: &'static str,
    /// Corners in the frame of the link, counter-clockwise seen from outside.
    pub polygon: Vec<[f64; 3]>,
}
