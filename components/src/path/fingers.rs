//! The fingers of a gripper: the joints that open and close it.

use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{GripperIndex, JointIndex};

/// The joints of one coordinate that move links beyond the body of the gripper's link: its fingers, those that mimic others
/// included. Tool frames that are fixed to a palm are one body with it. None where the gripper stands fixed in the world, or has
/// no joints beyond it.
#[must_use]
pub fn fingers(robot: &Robot, gripper: GripperIndex) -> Vec<JointIndex> {
    let Some(palm) = robot.links[robot.grippers[gripper.at()].link.at()].joint else { return Vec::new() };
    let part = &robot.parts[robot.joints[palm.at()].part.at()];
    let is_beyond = |joint: JointIndex| {
        let above = std::iter::successors(robot.joints[joint.at()].parent, |j| robot.joints[j.at()].parent);
        above.into_iter().any(|j| j == palm)
    };
    let joints = part.joints.clone().map(|index| JointIndex(index as u32));
    joints.filter(|&j| robot.joints[j.at()].motion.configuration_size() == 1 && is_beyond(j)).collect()
}
