//! The joints of a robot as kinematics reads them: how each is mounted, how it moves, and which coordinates move it.
//!
//! Scalar loops, tables for lanes, Jacobians, constraint programs and motion bounds all start from here.

use foliate_components::Pose;
use foliate_components::robot::{Joint, JointIndex, JointType, Robot, Source};

/// One joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointEntry {
    /// The body on which it is mounted; `None` for the world.
    pub(crate) parent: Option<JointIndex>,
    /// Pose of the joint frame at zero in the parent's joint frame, or in the world.
    pub(crate) X_PJ: Pose,
    pub(crate) motion: JointType,
    pub(crate) coordinates: JointCoordinates,
}

impl JointEntry {
    pub(crate) fn new(robot: &Robot, joint: &Joint) -> Self {
        Self {
            parent: joint.parent,
            X_PJ: joint.parent_from_joint,
            motion: joint.motion,
            coordinates: JointCoordinates::of(robot, joint),
        }
    }
}

/// The entries of all joints, in the robot's order: parents come first.
pub(crate) fn joint_table(robot: &Robot) -> Vec<JointEntry> {
    robot.joints.iter().map(|joint| JointEntry::new(robot, joint)).collect()
}

/// The coordinates that move a joint: its own, or the one of its leader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointCoordinates {
    /// The first in a configuration.
    pub(crate) q: usize,
    /// The first in a velocity.
    pub(crate) v: usize,
    /// A follower's value is `multiplier` · its leader's + `offset`, radians or metres; 1 and 0 for own coordinates.
    pub(crate) multiplier: f64,
    pub(crate) offset: f64,
}

impl JointCoordinates {
    pub(crate) fn of(robot: &Robot, joint: &Joint) -> Self {
        match joint.source {
            Source::Coordinates { q, v } => Self { q, v, multiplier: 1.0, offset: 0.0 },
            Source::Follows { leader, multiplier, offset } => match robot.joints[leader.at()].source {
                Source::Coordinates { q, v } => Self { q, v, multiplier, offset },
                // `Robot::compose` resolves chains: a follower of a follower cannot arise, and would not move.
                Source::Follows { .. } => Self { q: 0, v: 0, multiplier: 0.0, offset },
            },
        }
    }

    /// Value of a joint that turns or slides, radians or metres.
    #[inline]
    pub(crate) fn value(&self, q: &[f64]) -> f64 {
        self.multiplier * q[self.q] + self.offset
    }
}
