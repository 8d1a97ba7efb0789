//! Joints: how each moves its body, where its numbers come from; and how parts are placed in the world.

use crate::pose::{Pose, pose_to_array};
use crate::robot::error::CoordinateError;
use crate::robot::indices::{JointIndex, PartIndex};
use glam::{DQuat, DVec3};

/// How a joint moves its body, in the joint frame at zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointType {
    /// Rotation about a unit axis, radians.
    Revolute {
        /// Unit axis in the joint frame.
        axis: DVec3,
    },
    /// Translation along a unit axis, metres.
    Prismatic {
        /// Unit axis in the joint frame.
        axis: DVec3,
    },
    /// x, y, θ in the joint frame's xy plane (R² × SO(2)).
    Planar,
    /// Position and unit quaternion (R³ × SO(3)). Velocities: translation in the joint frame, rotation in the moving frame.
    FreeFlyer,
}

impl JointType {
    /// Number of numbers in a configuration: 1, 3 or 7.
    #[must_use]
    pub fn configuration_size(&self) -> usize {
        match self {
            Self::Revolute { .. } | Self::Prismatic { .. } => 1,
            Self::Planar => 3,
            Self::FreeFlyer => 7,
        }
    }

    /// Names of the numbers of a joint that has several, in their order; none of a joint that has one.
    #[must_use]
    pub fn axes(&self) -> &'static [&'static str] {
        match self {
            Self::Revolute { .. } | Self::Prismatic { .. } => &[],
            Self::Planar => &["x", "y", "theta"],
            Self::FreeFlyer => &["x", "y", "z", "qx", "qy", "qz", "qw"],
        }
    }

    /// Dimension of the velocity: 1, 3 or 6.
    #[must_use]
    pub fn velocity_size(&self) -> usize {
        match self {
            Self::Revolute { .. } | Self::Prismatic { .. } => 1,
            Self::Planar => 3,
            Self::FreeFlyer => 6,
        }
    }
}

/// How far the length of a quaternion may be off 1.
const UNIT: f64 = 1e-6;

/// What a joint's coordinates are set to by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoordinateValue {
    /// Of a revolute or prismatic joint: radians or metres.
    Number(f64),
    /// Of a planar root: x, y (metres) and θ (radians) in its plane.
    Planar([f64; 3]),
    /// Of a free-flyer: the pose of its body in the frame of the joint; of a part's root that is the pose in the world.
    Pose(Pose),
}

impl CoordinateValue {
    /// What numbers mean: one of a revolute or prismatic joint, three (x, y, θ) of a planar root, seven (x, y, z, and the quaternion
    /// x, y, z, w) of a free-flyer. `None` for other counts. A quaternion whose length is off 1 by less than 1e-6 is normalised;
    /// what is no value of a joint is refused where it is set.
    #[must_use]
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        match *numbers {
            [number] => Some(Self::Number(number)),
            [x, y, angle] => Some(Self::Planar([x, y, angle])),
            [x, y, z, qx, qy, qz, qw] => {
                let rotation = DQuat::from_xyzw(qx, qy, qz, qw);
                let is_unit = (rotation.length() - 1.0).abs() < UNIT;
                let rotation = if is_unit { rotation.normalize() } else { rotation };
                Some(Self::Pose(Pose::from_parts(DVec3::new(x, y, z), rotation)))
            }
            _ => None,
        }
    }

    /// The numbers, as [`Self::from_numbers`] reads them.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Number(number) => vec![*number],
            Self::Planar(numbers) => numbers.to_vec(),
            Self::Pose(pose) => pose_to_array(pose).to_vec(),
        }
    }

    /// Whether its numbers are finite and its quaternion is a rotation.
    pub(crate) fn check(&self, name: &str) -> Result<(), CoordinateError> {
        let is_finite = match self {
            Self::Number(number) => number.is_finite(),
            Self::Planar(numbers) => numbers.iter().all(|number| number.is_finite()),
            Self::Pose(pose) => pose.translation.is_finite() && pose.rotation.is_finite(),
        };
        match self {
            _ if !is_finite => Err(CoordinateError::NotFinite(name.into())),
            Self::Pose(pose) if (pose.rotation.length() - 1.0).abs() > UNIT => {
                Err(CoordinateError::NoRotation(name.into()))
            }
            Self::Number(_) | Self::Planar(_) | Self::Pose(_) => Ok(()),
        }
    }
}

impl From<f64> for CoordinateValue {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<[f64; 3]> for CoordinateValue {
    fn from(value: [f64; 3]) -> Self {
        Self::Planar(value)
    }
}

impl From<Pose> for CoordinateValue {
    fn from(value: Pose) -> Self {
        Self::Pose(value)
    }
}

/// Where a joint's value comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// Its own coordinates.
    Coordinates {
        /// First index in a configuration.
        q: usize,
        /// First index in a velocity.
        v: usize,
    },
    /// `multiplier · leader + offset` (URDF `mimic`); the leader has coordinates of its own.
    Follows {
        /// The joint that is followed; never itself a follower.
        leader: JointIndex,
        /// Factor.
        multiplier: f64,
        /// Offset, radians or metres.
        offset: f64,
    },
}

/// A joint that moves, and the rigid body beyond it.
#[derive(Clone, Debug)]
pub struct Joint {
    /// `part/joint`.
    pub name: String,
    /// Part it belongs to.
    pub part: PartIndex,
    /// Moving joint whose body carries this joint; `None` where that is the world.
    pub parent: Option<JointIndex>,
    /// Pose of the joint frame (at zero) in the parent joint's frame, or in the world.
    pub parent_from_joint: Pose,
    /// How it moves.
    pub motion: JointType,
    /// Where its value comes from.
    pub source: Source,
    /// Bounds on the joint's value, also for followers; infinite where there is none. One entry per configuration number.
    /// Those of a leader are no wider than its followers' own let it move.
    pub lower: Vec<f64>,
    /// Upper bounds, as `lower`.
    pub upper: Vec<f64>,
    /// Velocity limit as the URDF gives it, rad/s or m/s.
    pub velocity_limit: Option<f64>,
}

impl Joint {
    /// Whether all its coordinates lie between equal bounds, so that it never moves.
    #[must_use]
    pub fn is_immovable(&self) -> bool {
        self.lower.iter().zip(&self.upper).all(|(low, high)| low >= high)
    }
}

/// What the planner may do with a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PartKind {
    /// Has grippers or actuators: its joints move on their own.
    Robot,
    /// Moves only while it is held.
    Object,
    /// Never moves.
    Environment,
}

/// How a part's root link is attached to the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RootJoint {
    /// Rigidly.
    Fixed,
    /// By a free-flyer, R³ × SO(3).
    FreeFlyer,
    /// By a planar joint, R² × SO(2).
    Planar,
}

/// Where and how a model enters the world.
#[derive(Clone, Debug)]
pub struct PartPlacement {
    /// Part name, the prefix of its elements; unique, without `/`.
    pub name: String,
    /// Kind.
    pub kind: PartKind,
    /// Root joint.
    pub root: RootJoint,
    /// Pose of the root link (fixed) or of the root joint's frame (otherwise) in the world.
    pub world_from_root: Pose,
    /// Whether mimic joints follow (true) or are coordinates of their own (false).
    pub mimic_follows: bool,
    /// Bounds of the root's first coordinates as (lower, upper): x y z qx qy qz qw (free-flyer) or x y θ (planar), metres
    /// and radians; those that are left out are unlimited. A root whose bounds are all equal never moves. Bounds on a
    /// quaternion have no other use.
    pub root_bounds: Vec<(f64, f64)>,
    /// Bounds that replace the model's: joint name without prefix, lower, upper. A planar or floating joint of the model has
    /// bounds by number: `joint/x`, with the names of [`JointType::axes`].
    pub joint_bounds: Vec<(String, f64, f64)>,
}

impl PartPlacement {
    /// A part without bounds of its own; mimic joints follow.
    #[must_use]
    pub fn new(name: &str, kind: PartKind, root: RootJoint, world_from_root: Pose) -> Self {
        Self {
            name: name.into(),
            kind,
            root,
            world_from_root,
            mimic_follows: true,
            root_bounds: Vec::new(),
            joint_bounds: Vec::new(),
        }
    }
}
