//! Numbers of a configuration and objects that move freely, by name.

use crate::scene::assemble::names::configuration::{Reader, coordinate_names};
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::Item;
use foliate_components::robot::{JointType, Part, PartIndex, PartKind, Robot, RootJoint, Source};

/// Numbers of a configuration by name, and parts with the name of a configuration of their SRDF. Of a rotation all four are named or
/// none.
pub(super) fn coordinates(item: &Item<'_>, reader: &Reader<'_>) -> Result<Vec<(usize, f64)>, SceneError> {
    let (robot, names) = (reader.robot, coordinate_names(reader.robot));
    let mut coordinates: Vec<(usize, f64)> = Vec::new();
    let entries = item.keys()?.entries();
    for (name, item) in entries.iter().filter(|(_, item)| item.is_string()) {
        for (index, value) in reader.named_configuration(name, item)? {
            if reader.locked_value(index).is_some_and(|locked| (value - locked).abs() > 1e-9) {
                let message = format!("has `{}` where it is not locked", names[index]);
                return Err(item.error(message).hint("a locked joint never moves: name joints instead"));
            }
            coordinates.push((index, value));
        }
    }
    // Single values override those of a named configuration.
    for (name, item) in entries.iter().filter(|(_, item)| !item.is_string()) {
        let index = names.iter().position(|n| n == *name).ok_or_else(|| {
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
        coordinates.retain(|(known, _)| *known != index);
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

/// The freely moving object of a name.
pub(crate) fn moving_object(name: &str, item: &Item<'_>, robot: &Robot) -> Result<PartIndex, SceneError> {
    let moves = |p: &Part| p.kind == PartKind::Object && p.root == RootJoint::FreeFlyer;
    let part = robot.parts.iter().position(|p| p.name == name && moves(p)).ok_or_else(|| {
        let known = robot.parts.iter().filter(|p| moves(p)).map(|p| p.name.as_str());
        item.error("there is no freely moving object of this name").hint(did_you_mean(name, known))
    })?;
    Ok(PartIndex(part as u32))
}
