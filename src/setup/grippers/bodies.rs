//! The tree of a robot's bodies.

use foliate_components::robot::{JointIndex, Robot, Source};

/// Whether `body` is `ancestor` or moves with it.
pub(crate) fn is_beyond(robot: &Robot, body: Option<JointIndex>, ancestor: Option<JointIndex>) -> bool {
    let Some(ancestor) = ancestor else { return true };
    std::iter::successors(body, |at| robot.joints[at.at()].parent).any(|at| at == ancestor)
}

/// A body and all that it carries, in the robot's order.
pub(crate) fn beyond(robot: &Robot, body: JointIndex) -> Vec<JointIndex> {
    let all = (0..robot.joints.len() as u32).map(JointIndex);
    all.filter(|&joint| is_beyond(robot, Some(joint), Some(body))).collect()
}

/// The joint whose coordinate moves a joint: itself, or its leader.
pub(crate) fn leader(robot: &Robot, joint: JointIndex) -> JointIndex {
    match robot.joints[joint.at()].source {
        Source::Coordinates { .. } => joint,
        Source::Follows { leader, .. } => leader,
    }
}

/// The number of a joint in a configuration; none of one that follows another.
pub(crate) fn coordinate(robot: &Robot, joint: JointIndex) -> Option<usize> {
    match robot.joints[joint.at()].source {
        Source::Coordinates { q, .. } => Some(q),
        Source::Follows { .. } => None,
    }
}
