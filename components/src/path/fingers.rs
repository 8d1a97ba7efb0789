//! The fingers of a gripper: the joints that open and close it.

use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{GripperIndex, JointIndex};
use crate::robot::joint::Source;

/// The joints of one coordinate that move links beyond the body of the gripper's link and lead to no other gripper. Joints that mimic
/// others are left out: they follow. Tool frames that are fixed to a palm are one body with it. Empty where the gripper has no
/// joints.
#[must_use]
pub fn fingers(robot: &Robot, gripper: GripperIndex) -> Vec<JointIndex> {
    let link = &robot.links[robot.grippers[gripper.at()].link.at()];
    let above = |joint: JointIndex| std::iter::successors(Some(joint), |j| robot.joints[j.at()].parent);
    let is_beyond = |joint: JointIndex| link.joint.is_none_or(|palm| above(joint).skip(1).any(|j| j == palm));
    let others = robot.grippers.iter().enumerate().filter(|(index, _)| *index != gripper.at());
    let others: Vec<JointIndex> = others.filter_map(|(_, other)| robot.links[other.link.at()].joint).collect();
    let leads_on = |joint: JointIndex| others.iter().any(|&other| above(other).any(|j| j == joint));
    let is_moved = |joint: JointIndex| {
        let joint = &robot.joints[joint.at()];
        joint.motion.configuration_size() == 1 && matches!(joint.source, Source::Coordinates { .. })
    };
    let joints = robot.parts[link.part.at()].joints.clone().map(|index| JointIndex(index as u32));
    joints.filter(|&joint| is_moved(joint) && is_beyond(joint) && !leads_on(joint)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::Pose;
    use crate::robot::joint::{PartKind, PartPlacement, RootJoint};
    use crate::robot::model::GripperModel;
    use crate::samples::models::two_finger_hand;

    /// Names of the fingers of the first gripper, of a hand with grippers on these links.
    fn fingers_of(links: &[&str]) -> Vec<String> {
        let mut model = two_finger_hand();
        let gripper = |link: &&str| GripperModel {
            name: format!("on_{link}"),
            link: (*link).into(),
            link_from_gripper: Pose::identity(),
            clearance: 0.0,
        };
        model.grippers = links.iter().map(gripper).collect();
        let placement = PartPlacement::new("hand", PartKind::Robot, RootJoint::FreeFlyer, Pose::identity());
        let robot = Robot::compose(&[(&model, placement)]).expect("a hand");
        fingers(&robot, GripperIndex(0)).into_iter().map(|j| robot.joints[j.at()].name.clone()).collect()
    }

    #[test]
    fn fingers_are_beyond_the_palm_and_followers_are_none() {
        assert_eq!(fingers_of(&["palm"]), ["hand/left_finger"]);
        assert!(fingers_of(&["left"]).is_empty());
        // A joint that carries another gripper is an arm's.
        assert!(fingers_of(&["palm", "left"]).is_empty());
    }
}
