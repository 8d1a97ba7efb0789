//! The handles of an object for a gripper.

use crate::setup::grippers::{FoundGripper, GripperKind};
use crate::setup::handles::handle::{FoundHandle, HandleSettings, TURNS, farther_out, fitted};
use crate::setup::handles::{antipodal, primitives, tool_places};
use crate::setup::objects::RigidObject;
use foliate_components::Pose;
use glam::DQuat;
use std::f64::consts::TAU;

/// The handles by which a gripper can hold an object, the best first, each tested against the open hand's own shapes at the grasp and on
/// the way to it. The same input gives the same handles.
///
/// An object of one box, cylinder or sphere has all grasps of its kind: two jaws on opposite faces, from every side and both ways round;
/// about a cylinder and a sphere the turn is free. Any other object is sampled.
#[must_use]
pub fn handles(object: &RigidObject, gripper: &FoundGripper, settings: HandleSettings) -> Vec<FoundHandle> {
    let candidates = match gripper.kind {
        GripperKind::Tool => tool_places::places(object, settings),
        GripperKind::Jaws { .. } => match primitives::families(object, gripper) {
            Some(found) => found,
            None => return antipodal::grasps(object, gripper, settings),
        },
    };
    candidates.into_iter().flat_map(|handle| taken(object, gripper, handle)).collect()
}

/// The handle, where the hand can take it; else the nearest to it that it can take, farther out of the hand, and turned each way that was
/// left free about the object.
fn taken(object: &RigidObject, gripper: &FoundGripper, handle: FoundHandle) -> Vec<FoundHandle> {
    if let Some(handle) = fitted(object, gripper, &handle) {
        return vec![handle];
    }
    let turned = match handle.mask {
        [_, _, _, _, _, false] => (0..TURNS)
            .map(|turn| {
                let by = Pose::from_rotation(DQuat::from_rotation_z(TAU * turn as f64 / TURNS as f64));
                FoundHandle {
                    name: format!("{}_{}", handle.name, turn + 1),
                    link_from_handle: handle.link_from_handle * by,
                    mask: [true; 6],
                    reason: "from the side".into(),
                    ..handle.clone()
                }
            })
            .collect(),
        // What turns about the closing direction holds the same points from all sides; farther out it would turn about others.
        [_, _, _, _, false, true] => Vec::new(),
        _ => vec![handle],
    };
    turned.into_iter().filter_map(|handle| farther_out(object, gripper, &handle)).collect()
}
