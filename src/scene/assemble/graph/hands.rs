//! `[graph.hands]`: which joints are the fingers of a gripper, and how far they open.

use crate::scene::assemble::names::frame::one_of;
use crate::scene::assemble::names::locked::{scalar_joint, within};
use crate::scene::reading::error::{SceneError, did_you_mean};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::constraint::Tilt;
use foliate_components::problem::{Approach, ApproachLine, Finger, GraphOptions, Hand, Lift};
use foliate_components::robot::{GripperIndex, JointIndex, Robot};

/// How far fingers that approach stay off what they are to grasp where a scene does not say, metres.
const APPROACH_CLEARANCE: f64 = 5e-3;

/// The smallest distance from a line, metres: a few path tolerances.
const LEAST_DISTANCE: f64 = 1e-3;

/// `hands = { "robot/gripper" = { fingers = { "robot/joint" = { open = …, closed = … } } } or "planned" }`. `gripper` finds the gripper of a
/// name.
pub(super) fn read(
    item: &Item<'_>,
    robot: &Robot,
    locked: &[(JointIndex, f64)],
    gripper: impl Fn(&Item<'_>, &str) -> Result<GripperIndex, SceneError>,
) -> Result<Vec<Hand>, SceneError> {
    let mut hands: Vec<Hand> = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let grippers = vec![gripper(&item, name)?];
        if item.is_string() {
            one_of(&item, &[("planned", ())])?;
            hands.push(Hand { grippers, fingers: Vec::new() });
            continue;
        }
        let mut keys = item.keys()?;
        let mut fingers: Vec<Finger> = Vec::new();
        for (joint, item) in keys.required("fingers")?.keys()?.entries() {
            let finger = finger(&item, scalar_joint(&item, joint, robot)?, robot)?;
            if locked.iter().any(|(joint, _)| *joint == finger.joint) {
                return Err(item
                    .error("is locked as well")
                    .hint("a finger opens and closes, a locked joint never moves"));
            }
            fingers.push(finger);
        }
        keys.finish()?;
        if fingers.is_empty() {
            let hint = "\"planned\" makes the joints of the gripper joints as any";
            return Err(item.error("names no finger").hint(hint));
        }
        let shares = |hand: &&mut Hand| hand.fingers.iter().any(|f| fingers.iter().any(|own| own.joint == f.joint));
        match hands.iter_mut().find(shares) {
            Some(hand) if hand.fingers == fingers => hand.grippers.extend(grippers),
            Some(_) => {
                let hint = "grippers that share fingers have the same fingers, with the same values";
                return Err(item.error("has a finger of another gripper, and is not the same hand").hint(hint));
            }
            None => hands.push(Hand { grippers, fingers }),
        }
    }
    Ok(hands)
}

/// `approach = "wide"` or `"as-needed"`, and `approach_clearance`.
pub(super) fn approach(keys: &mut Keys<'_>) -> Result<Approach, SceneError> {
    let words = [("wide", Approach::Wide), ("as-needed", Approach::AsNeeded { clearance: APPROACH_CLEARANCE })];
    let approach = keys.optional("approach").map_or(Ok(Approach::default()), |item| one_of(&item, &words))?;
    let Some(item) = keys.optional("approach_clearance") else { return Ok(approach) };
    match approach {
        Approach::Wide => Err(item.error("has no meaning with approach = \"wide\"").hint("it is of \"as-needed\"")),
        Approach::AsNeeded { .. } => Ok(Approach::AsNeeded { clearance: item.distance()? }),
    }
}

/// `{ open = …, closed = …, travel = … }`: values of the joint, metres or radians.
fn finger(item: &Item<'_>, joint: JointIndex, robot: &Robot) -> Result<Finger, SceneError> {
    let mut keys = item.keys()?;
    let open = within(&keys.required("open")?, joint, robot)?;
    let closed = within(&keys.required("closed")?, joint, robot)?;
    let travel = keys.optional("travel").map(|item| within(&item, joint, robot)).transpose()?;
    keys.finish()?;
    if open == closed {
        return Err(item.error("is as far open as closed"));
    }
    Ok(Finger { joint, open, closed, travel })
}

/// `approach_line = { distance, angle }`: metres and radians.
pub(super) fn approach_line(keys: &mut Keys<'_>) -> Result<Option<ApproachLine>, SceneError> {
    keys.optional("approach_line").map(|item| line(&item)).transpose()
}

/// `approach_lines = { "robot/gripper" or "object/handle" = { distance, angle } or "free" }`: how these differ.
pub(super) fn approach_lines(keys: &mut Keys<'_>, robot: &Robot, options: &mut GraphOptions) -> Result<(), SceneError> {
    let Some(item) = keys.optional("approach_lines") else { return Ok(()) };
    for (name, item) in item.keys()?.entries() {
        let line = match item.is_string() {
            true => one_of(&item, &[("free", None)])?,
            false => Some(line(&item)?),
        };
        match (robot.gripper(name), robot.handle(name)) {
            (Some(gripper), None) => options.gripper_lines.push((gripper, line)),
            (None, Some(handle)) => options.handle_lines.push((handle, line)),
            (Some(_), Some(_)) => {
                return Err(item.error("is the name of a gripper and of a handle").hint("rename one"));
            }
            (None, None) => {
                let handles = robot.handles.iter().map(|handle| handle.name.as_str());
                let known = robot.grippers.iter().map(|gripper| gripper.name.as_str()).chain(handles);
                let hint = did_you_mean(name, known);
                return Err(item.error("there is no gripper and no handle of this name").hint(hint));
            }
        }
    }
    Ok(())
}

/// `{ distance, angle }` of a line.
fn line(item: &Item<'_>) -> Result<ApproachLine, SceneError> {
    let mut keys = item.keys()?;
    let (distance, angle) = (keys.required("distance")?, keys.required("angle")?);
    keys.finish()?;
    let line = ApproachLine { distance: distance.distance()?, angle: angle.number()? };
    if line.distance < LEAST_DISTANCE {
        return Err(distance.error(format!("is below {LEAST_DISTANCE} m: motions are not that exact")));
    }
    if !(Tilt::LEAST..=Tilt::MOST).contains(&line.angle) {
        return Err(angle.error(format!("is not between {} radians and a right angle", Tilt::LEAST)));
    }
    Ok(line)
}

/// `lift = "free"` or `"straight"`.
pub(super) fn lift(keys: &mut Keys<'_>) -> Result<Lift, SceneError> {
    let words = [("free", Lift::Free), ("straight", Lift::Straight)];
    keys.optional("lift").map_or(Ok(Lift::default()), |item| one_of(&item, &words))
}
