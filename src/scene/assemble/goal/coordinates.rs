//! `[[goal]]`: whole configurations, or requirements on any.

use crate::scene::assemble::graph::written::several;
use crate::scene::assemble::names::configuration::{Reader, coordinate_names};
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::Pose;
use foliate_components::problem::{Goal, NamedConstraint, PartialGoal};
use foliate_components::robot::{JointType, PartIndex, PartKind, Robot, RootJoint, Source};

/// Most goals of a scene.
const GOALS: usize = 10_000;

pub(super) fn read(
    item: &Item<'_>,
    reader: &Reader<'_>,
    start: &[f64],
    constraints: &[NamedConstraint],
) -> Result<Vec<Goal>, SceneError> {
    let items = item.list()?;
    if items.is_empty() || items.len() > GOALS {
        let message = format!("{} goals are given, 1 to {GOALS} are read", items.len());
        return Err(item.error(message).hint("a problem has at least one goal"));
    }
    items.iter().map(|item| goal(item, reader, start, constraints)).collect()
}

fn goal(
    item: &Item<'_>,
    reader: &Reader<'_>,
    start: &[f64],
    constraints: &[NamedConstraint],
) -> Result<Goal, SceneError> {
    let mut keys = item.keys()?;
    let whole = keys.optional("configuration");
    let partial = partial(&mut keys, reader, constraints)?;
    keys.finish()?;
    match (whole, partial == PartialGoal::default()) {
        (Some(whole), true) => Ok(Goal::Configuration(reader.whole_goal(&whole, start)?)),
        (None, false) => Ok(Goal::Partial(partial)),
        _ => {
            let hint = "or any of `objects`, `coordinates` and `constraints`, which are not empty";
            Err(item.error("wants either `configuration` alone").hint(hint))
        }
    }
}

/// `objects`, `coordinates` and `constraints`: all of them hold, everything else is free.
fn partial(
    keys: &mut Keys<'_>,
    reader: &Reader<'_>,
    constraints: &[NamedConstraint],
) -> Result<PartialGoal, SceneError> {
    let mut goal = PartialGoal::default();
    if let Some(item) = keys.optional("objects") {
        goal.poses = poses(&item, reader.robot)?;
    }
    if let Some(item) = keys.optional("coordinates") {
        goal.coordinates = coordinates(&item, reader)?;
    }
    if let Some(item) = keys.optional("constraints") {
        let numbers = several(&item, constraints.iter().map(|c| c.name.as_str()), "constraint")?;
        goal.constraints = numbers.into_iter().map(|i| constraints[i as usize].clone()).collect();
    }
    Ok(goal)
}

/// Poses of freely moving objects.
fn poses(item: &Item<'_>, robot: &Robot) -> Result<Vec<(PartIndex, Pose)>, SceneError> {
    item.keys()?
        .entries()
        .into_iter()
        .map(|(name, item)| Ok((moving_object(name, &item, robot)?, item.pose()?)))
        .collect()
}

/// The freely moving object of a name.
pub(super) fn moving_object(name: &str, item: &Item<'_>, robot: &Robot) -> Result<PartIndex, SceneError> {
    let moves = |p: &foliate_components::robot::Part| p.kind == PartKind::Object && p.root == RootJoint::FreeFlyer;
    let part = robot.parts.iter().position(|p| p.name == name && moves(p)).ok_or_else(|| {
        let known = robot.parts.iter().filter(|p| moves(p)).map(|p| p.name.as_str());
        item.error("there is no freely moving object of this name").hint(did_you_mean(name, known))
    })?;
    Ok(PartIndex(part as u32))
}

/// Numbers of a configuration by name. Of a rotation all four are named or none.
fn coordinates(item: &Item<'_>, reader: &Reader<'_>) -> Result<Vec<(usize, f64)>, SceneError> {
    let (robot, names) = (reader.robot, coordinate_names(reader.robot));
    let mut coordinates = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let index = names.iter().position(|n| n == name).ok_or_else(|| {
            let known = names.iter().map(String::as_str);
            item.error(format!("there is no coordinate `{}`", quoted(name))).hint(did_you_mean(name, known))
        })?;
        let (value, low, high) = (item.number()?, robot.space.lower[index], robot.space.upper[index]);
        if !(low..=high).contains(&value) {
            return Err(item.error(format!("{value} is outside the bounds, [{low}, {high}]")));
        }
        if reader.locked_value(index).is_some_and(|locked| (value - locked).abs() > 1e-9) {
            return Err(item.error("is locked at another value").hint("a locked joint never moves"));
        }
        coordinates.push((index, value));
    }
    whole_rotations(item, &coordinates, robot)?;
    Ok(coordinates)
}

fn whole_rotations(item: &Item<'_>, coordinates: &[(usize, f64)], robot: &Robot) -> Result<(), SceneError> {
    for joint in robot.joints.iter().filter(|j| j.motion == JointType::FreeFlyer) {
        let Source::Coordinates { q, .. } = joint.source else { continue };
        let named: Vec<f64> =
            coordinates.iter().filter(|(i, _)| (q + 3..q + 7).contains(i)).map(|(_, value)| *value).collect();
        let length = named.iter().map(|x| x * x).sum::<f64>().sqrt();
        match named.len() {
            0 => {}
            4 if (length - 1.0).abs() < 1e-3 => {}
            4 => return Err(item.error(format!("the quaternion of `{}` has length {length:.4}", joint.name))),
            _ => {
                let hint = "name qx, qy, qz and qw, or none of them";
                return Err(item.error(format!("names a part of the rotation of `{}`", joint.name)).hint(hint));
            }
        }
    }
    Ok(())
}
