//! Grippers that documents declare, as frames: the size of the hand that they belong to.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::bodies::beyond;
use crate::setup::grippers::find::with_solids;
use crate::setup::grippers::hand::{FoundGripper, GripperKind};
use foliate_components::Pose;
use foliate_components::robot::model::GripperModel;
use foliate_components::robot::{LinkIndex, Robot};
use glam::DVec3;

/// Frames that are nearer are the same, metres and radians: rounding.
const SAME: f64 = 5e-6;
/// How far the axes of a frame may be from those of the hand, radians.
const AXES: f64 = 0.02;
/// How far it may be beside the middle between the jaws, metres.
const BESIDE: f64 = 2e-3;

/// The gripper of a document of the robot's only part: of the hand on its body, or a tool. x of its frame approaches, y closes.
///
/// # Errors
/// Why its frame does not say how it holds, in words.
pub(crate) fn declared(robot: &Robot, hands: &[FoundGripper], gripper: &GripperModel) -> Result<FoundGripper, String> {
    let part = robot.parts.first().map_or("", |part| part.name.as_str());
    let link = robot.link(&format!("{part}/{}", gripper.link)).unwrap_or(LinkIndex(0));
    let body = robot.links[link.at()].joint;
    let in_body = |link: LinkIndex, pose: &Pose| robot.links[link.at()].joint_from_link * *pose;
    let X_BD = in_body(link, &gripper.link_from_gripper);
    let own = FoundGripper {
        name: gripper.name.clone(),
        link,
        link_from_gripper: gripper.link_from_gripper,
        kind: GripperKind::Tool,
        fingers: Vec::new(),
        reason: format!("declared on `{}`", gripper.link),
        solids: Vec::new(),
    };
    let Some(hand) = hands.iter().find(|hand| robot.links[hand.link.at()].joint == body) else {
        return match body.is_some_and(|body| beyond(robot, body).len() > 1) {
            true => Err("joints move beyond its link, and no jaws are found there".into()),
            false => Ok(with_solids(robot, own)),
        };
    };
    // The declared frame in the one that was found.
    let X_FD = in_body(hand.link, &hand.link_from_gripper).inverse() * X_BD;
    let [x, y] = [X_FD.rotation * DVec3::X, X_FD.rotation * DVec3::Y];
    let GripperKind::Jaws { opening, shut, depth, tip, one_moves } = hand.kind else {
        return Ok(with_solids(robot, own));
    };
    // Turned by half a turn about the approach, two jaws are the same hand.
    let (ahead, back) = (y.angle_between(DVec3::Y), y.angle_between(-DVec3::Y));
    let (off_x, off_y) = (x.angle_between(DVec3::X), if one_moves { ahead } else { ahead.min(back) });
    if off_x.max(off_y) > AXES {
        return Err(format!(
            "its x axis is {:.2} radians from the approach of the jaws and its y axis {:.2} from their closing direction",
            off_x, off_y
        ));
    }
    let t = X_FD.translation;
    if t.y.abs().max(t.z.abs()) > BESIDE {
        return Err(format!("it is {:.1} mm beside the middle between the jaws", 1e3 * t.y.hypot(t.z)));
    }
    // What a setup wrote is what it found, to the last digit.
    if t.length() < SAME && off_x.max(ahead) < SAME {
        let (name, reason) = (own.name, own.reason);
        return Ok(with_solids(robot, FoundGripper { name, reason, ..hand.clone() }));
    }
    let kind = GripperKind::Jaws { opening, shut, depth: depth + t.x, tip: tip - t.x, one_moves };
    Ok(with_solids(robot, FoundGripper { kind, fingers: hand.fingers.clone(), ..own }))
}
