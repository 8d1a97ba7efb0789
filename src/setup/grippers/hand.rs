//! A gripper that was found: its frame, its fingers, its size.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::bodies::{coordinate, leader};
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, LinkIndex, Robot};
use foliate_kernels::collision::{DistanceQuery, Solid, clearance};
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;
use std::fmt;

/// How a gripper holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GripperKind {
    /// Two jaws that close along y of the gripper's frame.
    Jaws {
        /// Distance between the jaws where they are wide open, metres.
        opening: f64,
        /// Distance where they are shut, metres.
        shut: f64,
        /// How far behind the origin of the frame the palm is, metres: an object reaches no farther into the hand.
        depth: f64,
        /// How far the tips are ahead of the origin, metres.
        tip: f64,
        /// Whether the jaw on the side of y moves alone: what is held lies against the other one.
        one_moves: bool,
    },
    /// A tool that holds at its tip, such as a suction cup: the origin of the frame.
    Tool,
}

impl fmt::Display for GripperKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Jaws { opening, shut, depth, tip, one_moves } => {
                let [opening, shut, depth, tip] = [opening, shut, depth, tip].map(|metres| metres * 1e3);
                write!(f, "opens {opening:.1} mm and shuts to {shut:.1} mm; ")?;
                write!(f, "the palm is {depth:.1} mm behind the frame, the tips {tip:.1} mm ahead")?;
                if one_moves { f.write_str("; the jaw on the side of y moves alone") } else { Ok(()) }
            }
            Self::Tool => f.write_str("holds what its tip touches"),
        }
    }
}

/// A joint of one coordinate that opens and closes a gripper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FingerRange {
    /// The joint.
    pub joint: JointIndex,
    /// Its value where the gripper is wide open, metres or radians.
    pub open: f64,
    /// Its value where it is shut.
    pub closed: f64,
}

/// A gripper that was found in a robot. Its frame has x along the approach, y along the closing direction.
#[derive(Clone, Debug)]
pub struct FoundGripper {
    /// A name, unique in the robot, without its part.
    pub name: String,
    /// The link that carries it.
    pub link: LinkIndex,
    /// Its frame in that link.
    pub link_from_gripper: Pose,
    /// How it holds.
    pub kind: GripperKind,
    /// Its fingers; none of a tool.
    pub fingers: Vec<FingerRange>,
    /// How it was found, in words.
    pub reason: String,
    /// The solids of the hand where it is wide open, in its frame.
    pub(crate) solids: Vec<(Pose, Solid)>,
}

impl FoundGripper {
    /// Whether a body is one of its fingers, or beyond one.
    pub(crate) fn moves(&self, robot: &Robot, body: Option<JointIndex>) -> bool {
        let is_finger = |joint: JointIndex| self.fingers.iter().any(|finger| finger.joint == leader(robot, joint));
        std::iter::successors(body, |at| robot.joints[at.at()].parent).any(is_finger)
    }

    /// The poses of all bodies where the fingers are at `share` of the way from open to shut, everything else at its default.
    pub(crate) fn poses(&self, robot: &Robot, share: f64) -> Vec<Pose> {
        let mut q = robot.space.neutral();
        robot.space.clamp(&mut q);
        for finger in &self.fingers {
            if let Some(at) = coordinate(robot, finger.joint) {
                q[at] = finger.open + share * (finger.closed - finger.open);
            }
        }
        let kinematics = Kinematics::new(robot);
        kinematics.poses(&q)
    }

    /// Its frame in the world.
    pub(crate) fn in_world(&self, robot: &Robot, X_WJ: &[Pose]) -> Pose {
        let link = &robot.links[self.link.at()];
        let X_WB = link.joint.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]);
        X_WB * link.joint_from_link * self.link_from_gripper
    }

    /// Whether the open hand keeps `gap` metres from solids that are posed in its frame.
    pub(crate) fn is_clear(&self, object: &[(Pose, Solid)], X_GO: &Pose, gap: f64) -> bool {
        let query = DistanceQuery::exact(gap);
        let clear = |(X_GS, hand): &(Pose, Solid), (X_OS, solid): &(Pose, Solid)| {
            clearance(hand, X_GS, solid, &(*X_GO * *X_OS), query, &mut DVec3::ZERO.clone()) >= gap
        };
        self.solids.iter().all(|hand| object.iter().all(|solid| clear(hand, solid)))
    }
}
