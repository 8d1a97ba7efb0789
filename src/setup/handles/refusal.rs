//! Why an object has no handles.

use crate::setup::error::SetupError;
use crate::setup::grippers::FoundGripper;
use crate::setup::grippers::GripperKind::{Jaws, Tool};
use crate::setup::objects::RigidObject;

/// That no gripper can hold an object, with the sizes.
pub(crate) fn no_grasp(object: &RigidObject, grippers: &[FoundGripper]) -> SetupError {
    let (low, high) = object.bounds;
    let size = (high - low) * 1e3;
    let hand = |gripper: &FoundGripper| match gripper.kind {
        Jaws { opening, depth, .. } => {
            format!("`{}` opens {:.0} mm and takes {:.0} mm into the hand", gripper.name, opening * 1e3, depth * 1e3)
        }
        Tool => format!("`{}` finds no flat place for its tip", gripper.name),
    };
    let hands: Vec<String> = grippers.iter().map(hand).collect();
    let fits = grippers.iter().any(|gripper| match gripper.kind {
        Jaws { opening, .. } => (high - low).min_element() < opening,
        Tool => false,
    });
    let blocked = if fits { "; where it fits between the jaws, the open hand's own shapes are in the way" } else { "" };
    let scale = match size.max_element() > 3000.0 {
        true => "; are its lengths millimetres? Write \"FILE 0.001\"",
        false => "",
    };
    let reason =
        format!("it is {:.0} x {:.0} x {:.0} mm, and {}{scale}{blocked}", size.x, size.y, size.z, hands.join(", "));
    SetupError::NoGrasp { object: object.name.clone(), reason }
}
