//! `[timing]`, `[cost]`, and the rate limits of a `[[part]]`.

use crate::scene::assemble::names::frame::one_of;
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::problem::cost::MotionCost;
use foliate_components::problem::{CostOptions, NumberLimit, TimingOptions};
use foliate_components::robot::{JointIndex, PartIndex, PartKind, Robot};

/// `velocity_limits` and `acceleration_limits` of a part, to be read once joints have numbers.
pub(crate) struct PartRates<'f> {
    velocity: Option<Item<'f>>,
    acceleration: Option<Item<'f>>,
}

impl<'f> PartRates<'f> {
    pub fn of(keys: &mut Keys<'f>) -> Self {
        Self { velocity: keys.optional("velocity_limits"), acceleration: keys.optional("acceleration_limits") }
    }
}

/// `[timing]`. The scene's own limits come after those of its parts, so that they count.
pub(crate) fn timing<'r, 'f: 'r>(
    keys: &mut Keys<'f>,
    robot: &Robot,
    parts: impl Iterator<Item = (&'r str, &'r PartRates<'f>)>,
) -> Result<TimingOptions, SceneError> {
    let mut timing = TimingOptions::default();
    for (part, rates) in parts {
        let prefix = format!("{part}/");
        limits(rates.velocity.as_ref(), &prefix, robot, &mut timing.velocity)?;
        limits(rates.acceleration.as_ref(), &prefix, robot, &mut timing.acceleration)?;
    }
    let Some(item) = keys.optional("timing") else { return Ok(timing) };
    let mut keys = item.keys()?;
    if let Some(item) = keys.optional("velocity_scale") {
        timing.velocity_scale = match positive(&item)? {
            x if x <= 1.0 => x,
            x => return Err(item.error(format!("is above 1: {x}")).hint("`velocity` gives a joint a greater limit")),
        };
    }
    limits(keys.optional("velocity").as_ref(), "", robot, &mut timing.velocity)?;
    limits(keys.optional("acceleration").as_ref(), "", robot, &mut timing.acceleration)?;
    if let Some(item) = keys.optional("ramp") {
        timing.ramp = positive(&item)?;
    }
    if let Some(item) = keys.optional("jerk_ramp") {
        timing.jerk_ramp = item.distance()?;
    }
    if let Some(item) = keys.optional("object_speed") {
        timing.object_speed = object_speed(&item, robot)?;
    }
    if let Some(item) = keys.optional("dwell") {
        timing.dwell = item.distance()?;
    }
    keys.finish()?;
    Ok(timing)
}

/// `object_speed = { object = limit }`.
fn object_speed(item: &Item<'_>, robot: &Robot) -> Result<Vec<(PartIndex, f64)>, SceneError> {
    let objects = || (0u32..).map(PartIndex).zip(&robot.parts).filter(|(_, part)| part.kind == PartKind::Object);
    let mut limits = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let Some((index, _)) = objects().find(|(_, part)| part.name == name) else {
            let known = objects().map(|(_, part)| part.name.as_str());
            return Err(item.error("there is no object of this name").hint(did_you_mean(name, known)));
        };
        limits.push((index, positive(&item)?));
    }
    Ok(limits)
}

/// `[cost]`.
pub(crate) fn cost(keys: &mut Keys<'_>) -> Result<CostOptions, SceneError> {
    let mut cost = CostOptions::default();
    let Some(item) = keys.optional("cost") else { return Ok(cost) };
    let mut keys = item.keys()?;
    if let Some(item) = keys.optional("motion") {
        cost.motion = one_of(&item, &[("duration", MotionCost::Duration), ("length", MotionCost::Length)])?;
    }
    if let Some(item) = keys.optional("grasp_charge") {
        cost.grasp_charge = item.distance()?;
    }
    keys.finish()?;
    Ok(cost)
}

fn positive(item: &Item<'_>) -> Result<f64, SceneError> {
    match item.number()? {
        x if x > 0.0 => Ok(x),
        x => Err(item.error(format!("is not above 0: {x}"))),
    }
}

/// A table of limits by name.
fn limits(item: Option<&Item<'_>>, prefix: &str, robot: &Robot, out: &mut Vec<NumberLimit>) -> Result<(), SceneError> {
    let Some(item) = item else { return Ok(()) };
    for (name, item) in item.keys()?.entries() {
        let numbers = numbers(robot);
        let known = numbers.iter().filter_map(|(known, ..)| known.strip_prefix(prefix));
        let Some((_, joint, number)) = numbers.iter().find(|(known, ..)| known.strip_prefix(prefix) == Some(name))
        else {
            let message = format!("there is no joint or coordinate `{}`", quoted(name));
            return Err(item.error(message).hint(did_you_mean(name, known)));
        };
        out.push(NumberLimit { joint: *joint, number: *number, limit: positive(&item)? });
    }
    Ok(())
}

/// Names of all numbers of all joints: those of coordinates, and those of joints that follow others.
fn numbers(robot: &Robot) -> Vec<(String, JointIndex, usize)> {
    let mut numbers = Vec::new();
    for (index, joint) in robot.joints.iter().enumerate() {
        let index = JointIndex(index as u32);
        let part = &robot.parts[joint.part.at()];
        let prefix = if part.root_joint == Some(index) { &part.name } else { &joint.name };
        match joint.motion.axes() {
            [] => numbers.push((joint.name.clone(), index, 0)),
            axes => numbers.extend(axes.iter().enumerate().map(|(k, axis)| (format!("{prefix}/{axis}"), index, k))),
        }
    }
    numbers
}
