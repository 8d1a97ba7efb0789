//! The hybrid robot: every robot, object and environment part as one kinematic tree (P0 §II-A).
//!
//! [`model`] describes one part as a file does (links, joints, documents) and knows no world; [`Robot::compose`] joins
//! any number of models into one tree, numbers their coordinates and absorbs fixed joints into bodies. The result is
//! immutable during a search.

use crate::pose::{Pose, pose_from_array, pose_to_array};
use crate::robot::configuration::ConfigurationSpace;
use crate::robot::error::CoordinateError;
use crate::robot::indices::{GripperIndex, HandleIndex, JointIndex, LinkIndex, PartIndex, ShapeIndex, SurfaceIndex};
use crate::robot::joint::{CoordinateValue, Joint, JointType, PartKind, RootJoint, Source};
use crate::robot::limits::NarrowedLimits;
use crate::robot::model;
use crate::robot::shape::geometry::Geometry;
use glam::DVec3;
use std::ops::Index;

/// Every part of a problem as one kinematic tree, with its documents. Names are `part/name` throughout.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Resource))]
pub struct Robot {
    /// The parts, in the order in which they were composed.
    pub parts: Vec<Part>,
    /// Joints that move, parents before children, grouped by part. Fixed joints are absorbed.
    pub joints: Vec<Joint>,
    /// All links, fixed ones included.
    pub links: Vec<Link>,
    /// Collision shapes.
    pub shapes: Vec<Shape>,
    /// Documented grippers.
    pub grippers: Vec<Gripper>,
    /// Documented handles.
    pub handles: Vec<Handle>,
    /// Documented contact surfaces.
    pub surfaces: Vec<Surface>,
    /// Pairs of links whose collisions their own part's SRDF disables, with its reason.
    pub disabled_pairs: Vec<DisabledPair>,
    /// Joints whose range their followers' own limits make smaller; their bounds are the smaller ones already.
    pub narrowed: Vec<NarrowedLimits>,
    /// The configuration space: the product of the joints' Lie groups.
    pub space: ConfigurationSpace,
}

/// One robot, object or environment.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name, the prefix of all its elements.
    pub name: String,
    /// What the planner may do with it.
    pub kind: PartKind,
    /// How its root link is attached to the world.
    pub root: RootJoint,
    /// Pose of the root link in the world where the root is fixed; of the plane where it is planar.
    pub world_from_root: Pose,
    /// Its root link.
    pub root_link: LinkIndex,
    /// The joint that moves the whole part, where its root is not fixed.
    pub root_joint: Option<JointIndex>,
    /// Its joints, root joint included, as a contiguous range of [`Robot::joints`].
    pub joints: std::ops::Range<usize>,
    /// Its links, as a contiguous range of [`Robot::links`].
    pub links: std::ops::Range<usize>,
    /// Whether joints that mimic others follow them (no coordinate) or are coordinates like any other.
    pub mimic_follows: bool,
    /// Whether the part came with an SRDF; without one, links that one joint joins and that touch wherever it is are not tested
    /// for collision.
    pub has_srdf: bool,
    /// Named configurations (`group_state`s of the SRDF): joint name without prefix and value.
    pub group_states: Vec<model::GroupState>,
}

/// A rigid link, attached to a moving joint or to the world.
#[derive(Clone, Debug)]
pub struct Link {
    /// `part/link`.
    pub name: String,
    /// Part it belongs to.
    pub part: PartIndex,
    /// Moving joint whose body it is part of; `None` where it is fixed to the world.
    pub joint: Option<JointIndex>,
    /// Pose of the link in that joint's frame, or in the world.
    pub joint_from_link: Pose,
    /// The link that carries it by a joint of the model, fixed or moving; `None` for the part's root link.
    pub parent: Option<LinkIndex>,
    /// Mass properties, where the file gives them.
    pub inertial: Option<model::Inertial>,
}

/// A collision shape on a link.
#[derive(Clone, Debug)]
pub struct Shape {
    /// `part/link_0`: the link's name and the shape's number on it (pinocchio's naming).
    pub name: String,
    /// The link that carries it.
    pub link: LinkIndex,
    /// Pose of the shape in the joint frame of its link (or in the world).
    pub joint_from_shape: Pose,
    /// The solid.
    pub geometry: Geometry,
}

/// A frame that may hold handles: its x axis approaches, its z axis is the free axis of axial handles (P0 §II-C.2).
#[derive(Clone, Debug)]
pub struct Gripper {
    /// `part/gripper`.
    pub name: String,
    /// The link that carries it.
    pub link: LinkIndex,
    /// Pose of the gripper frame in that link.
    pub link_from_gripper: Pose,
    /// Stand-off, metres; the pre-grasp distance is the sum of both clearances.
    pub clearance: f64,
}

/// A frame on an object where a gripper may hold it (P0 §II-C.2).
#[derive(Clone, Debug)]
pub struct Handle {
    /// `part/handle`.
    pub name: String,
    /// The link that carries it.
    pub link: LinkIndex,
    /// Pose of the handle frame in that link.
    pub link_from_handle: Pose,
    /// Stand-off, metres.
    pub clearance: f64,
    /// Which of tx ty tz rx ry rz (handle in gripper) a grasp forces to zero.
    pub mask: [bool; 6],
    /// Which of them are frozen along a motion while held.
    pub mask_complement: [bool; 6],
    /// Approach direction in the handle frame where the SRDF gives one (HPP ≥ 8); unit.
    pub approaching_direction: DVec3,
}

/// Convex planar polygons of a link that may touch others; normals point out of the solid (P0 §II-C.1).
#[derive(Clone, Debug)]
pub struct Surface {
    /// `part/surface`.
    pub name: String,
    /// The link that carries it.
    pub link: LinkIndex,
    /// Vertices in the link frame.
    pub points: Vec<DVec3>,
    /// Polygons as indices into `points`, counter-clockwise seen from outside.
    pub polygons: Vec<Vec<u32>>,
}

/// A pair of links that is never tested for collision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DisabledPair {
    /// One link.
    pub first: LinkIndex,
    /// The other.
    pub second: LinkIndex,
    /// Why, in the SRDF's or the scene's words.
    pub reason: String,
}

impl DisabledPair {
    /// The reason of pairs that are left out because one joint joins them and they touch wherever it is.
    pub const ADJACENT: &str = "adjacent";
}

impl Robot {
    /// The part of that name.
    #[must_use]
    pub fn part(&self, name: &str) -> Option<PartIndex> {
        position(&self.parts, |p| p.name == name).map(PartIndex)
    }

    /// The moving joint `part/joint`.
    #[must_use]
    pub fn joint(&self, name: &str) -> Option<JointIndex> {
        position(&self.joints, |j| j.name == name).map(JointIndex)
    }

    /// The link `part/link`.
    #[must_use]
    pub fn link(&self, name: &str) -> Option<LinkIndex> {
        position(&self.links, |l| l.name == name).map(LinkIndex)
    }

    /// The gripper `part/gripper`.
    #[must_use]
    pub fn gripper(&self, name: &str) -> Option<GripperIndex> {
        position(&self.grippers, |g| g.name == name).map(GripperIndex)
    }

    /// The handle `part/handle`.
    #[must_use]
    pub fn handle(&self, name: &str) -> Option<HandleIndex> {
        position(&self.handles, |h| h.name == name).map(HandleIndex)
    }

    /// The contact surface `part/surface`.
    #[must_use]
    pub fn surface(&self, name: &str) -> Option<SurfaceIndex> {
        position(&self.surfaces, |s| s.name == name).map(SurfaceIndex)
    }

    /// Sets the coordinates of one joint in a whole configuration `q`, by name: `part/joint`, or the name of a part for the joint
    /// that moves the whole part. Bounds are not checked here; a search refuses a start or a goal that is outside.
    ///
    /// # Errors
    /// Nothing that moves has the name, it follows another joint, or it takes another kind of value; a number is not finite, a
    /// quaternion no rotation.
    ///
    /// # Panics
    /// If `q` is shorter than a configuration.
    pub fn set(&self, q: &mut [f64], name: &str, value: impl Into<CoordinateValue>) -> Result<(), CoordinateError> {
        let (first, joint) = self.coordinates_of(name)?;
        let kind = |takes| CoordinateError::Kind { name: name.into(), takes };
        let value = value.into();
        value.check(name)?;
        match (joint.motion, value) {
            (JointType::Revolute { .. } | JointType::Prismatic { .. }, CoordinateValue::Number(x)) => q[first] = x,
            (JointType::Planar, CoordinateValue::Planar(x)) => q[first..first + 3].copy_from_slice(&x),
            (JointType::FreeFlyer, CoordinateValue::Pose(x)) => q[first..first + 7].copy_from_slice(&pose_to_array(&x)),
            (JointType::Revolute { .. } | JointType::Prismatic { .. }, _) => return Err(kind("a number")),
            (JointType::Planar, _) => return Err(kind("x, y and theta")),
            (JointType::FreeFlyer, _) => return Err(kind("a pose")),
        }
        Ok(())
    }

    /// The coordinates of one joint in a whole configuration `q`, by a name as for [`Self::set`].
    ///
    /// # Errors
    /// Nothing that moves has the name, or it follows another joint.
    ///
    /// # Panics
    /// If `q` is shorter than a configuration.
    pub fn get(&self, q: &[f64], name: &str) -> Result<CoordinateValue, CoordinateError> {
        let (first, joint) = self.coordinates_of(name)?;
        Ok(match joint.motion {
            JointType::Revolute { .. } | JointType::Prismatic { .. } => CoordinateValue::Number(q[first]),
            JointType::Planar => CoordinateValue::Planar([q[first], q[first + 1], q[first + 2]]),
            JointType::FreeFlyer => {
                let mut numbers = [0.0; 7];
                numbers.copy_from_slice(&q[first..first + 7]);
                CoordinateValue::Pose(pose_from_array(numbers).unwrap_or_else(Pose::identity))
            }
        })
    }

    /// The first coordinate of a joint, by name, and the joint.
    pub(crate) fn coordinates_of(&self, name: &str) -> Result<(usize, &Joint), CoordinateError> {
        let joint = match (self.joint(name), self.part(name)) {
            (Some(joint), _) => joint,
            (None, Some(part)) => self[part].root_joint.ok_or_else(|| CoordinateError::FixedRoot(name.into()))?,
            (None, None) => return Err(CoordinateError::Unknown(name.into())),
        };
        match self[joint].source {
            Source::Coordinates { q, .. } => Ok((q, &self[joint])),
            Source::Follows { .. } => Err(CoordinateError::Follows(name.into())),
        }
    }

    /// The moving joint and the pose in its frame of `link_from_frame`, a frame given in a link.
    #[must_use]
    pub fn frame_on_joint(&self, link: LinkIndex, link_from_frame: &Pose) -> (Option<JointIndex>, Pose) {
        let link = &self.links[link.at()];
        (link.joint, link.joint_from_link * *link_from_frame)
    }
}

/// Lets an index type index what it names.
macro_rules! indexed {
    ($($index:ty => $field:ident: $item:ty),* $(,)?) => {$(
        impl Index<$index> for Robot {
            type Output = $item;

            fn index(&self, index: $index) -> &$item {
                &self.$field[index.at()]
            }
        }
    )*};
}
indexed!(
    PartIndex => parts: Part,
    JointIndex => joints: Joint,
    LinkIndex => links: Link,
    ShapeIndex => shapes: Shape,
    GripperIndex => grippers: Gripper,
    HandleIndex => handles: Handle,
    SurfaceIndex => surfaces: Surface,
);

fn position<T>(items: &[T], matches: impl Fn(&T) -> bool) -> Option<u32> {
    items.iter().position(matches).map(|i| i as u32)
}
