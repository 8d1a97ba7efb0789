//! What a goal asks besides poses, numbers and constraints: what lies on which support, within which region, what hands hold, and
//! numbers that are near a value.
#![allow(non_snake_case, reason = "pose and matrix names carry their frames")]

use crate::scene::assemble::goal::coordinates::{coordinates, moving_object};
use crate::scene::assemble::names::configuration::Reader;
use crate::scene::assemble::names::frame::{ReadFrame, box_bounds, frame};
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::Item;
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Reference, RelativePose, Row, Rows};
use foliate_components::problem::{GraphOptions, Holding, NamedConstraint, OtherHands};
use foliate_components::robot::{GripperIndex, JointType, PartIndex, PartKind, Robot, Source, SurfaceIndex};
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::PI;

/// Most regions of a goal.
const REGIONS: usize = 1000;

/// `near`: numbers by name, and how far they may be off.
pub(super) fn near(item: &Item<'_>, reader: &Reader<'_>) -> Result<Vec<(usize, f64, f64)>, SceneError> {
    let mut keys = item.keys()?;
    let numbers = coordinates(&keys.required("coordinates")?, reader)?;
    let tolerance = keys.required("tolerance")?.distance()?;
    keys.finish()?;
    let turns = |index: usize| {
        reader.robot.joints.iter().any(|joint| {
            let numbers = |q: usize| q..q + joint.motion.configuration_size();
            let is_its = matches!(joint.source, Source::Coordinates { q, .. } if numbers(q).contains(&index));
            is_its && joint.motion == JointType::FreeFlyer
        })
    };
    if numbers.iter().any(|&(index, _)| turns(index)) {
        return Err(item
            .error("names numbers of a pose")
            .hint("take `within` for where an object is, or `objects` for its pose"));
    }
    Ok(numbers.into_iter().map(|(index, value)| (index, value, tolerance)).collect())
}

/// `on`: an object and the support on which it lies, or several of which it lies on one.
pub(super) fn on(
    item: &Item<'_>,
    robot: &Robot,
    graph: &GraphOptions,
) -> Result<Vec<(PartIndex, Vec<SurfaceIndex>)>, SceneError> {
    let support = |item: &Item<'_>| {
        let name = item.string()?;
        let index = robot.surface(name).filter(|surface| graph.supports.contains(surface));
        let known = graph.supports.iter().map(|surface| robot.surfaces[surface.at()].name.as_str());
        index.ok_or_else(|| {
            let message = format!("`{}` is no support of the graph", quoted(name));
            item.error(message).hint(did_you_mean(name, known))
        })
    };
    let mut lying = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let part = moving_object(name, &item, robot)?;
        if !graph.objects.iter().any(|object| object.part == part && !object.surfaces.is_empty()) {
            return Err(item.error("has no contact surface: it lies nowhere"));
        }
        let supports = match item.is_string() {
            true => vec![support(&item)?],
            false => item.list()?.iter().map(support).collect::<Result<_, _>>()?,
        };
        if supports.is_empty() {
            return Err(item.error("names no support"));
        }
        lying.push((part, supports));
    }
    Ok(lying)
}

/// `within`: boxes in which origins of objects are, as constraints that are not negative.
pub(super) fn within(item: &Item<'_>, robot: &Robot) -> Result<Vec<NamedConstraint>, SceneError> {
    let items = item.list()?;
    if items.len() > REGIONS {
        return Err(item.error(format!("there are more than {REGIONS} regions")));
    }
    let mut constraints = Vec::new();
    for item in &items {
        let mut keys = item.keys()?;
        let named = keys.required("object")?;
        let part = moving_object(named.string()?, &named, robot)?;
        let of = keys.optional("frame").map_or(Ok(ReadFrame::world()), |item| frame(&item, robot))?;
        if of.part == Some(part) {
            return Err(item.error("the region moves with the object").hint("name a `frame` of something else"));
        }
        let bounds = box_bounds(&mut keys, item)?;
        keys.finish()?;
        if let Some(why) = outside_root_bounds(robot, part, &of.frame, bounds) {
            return Err(item.error(why).hint("move the region, or widen `root_bounds` of the object"));
        }
        let origin = Frame::on_link(robot, robot[part].root_link, &Pose::identity());
        let name = format!("{} within its region", robot[part].name);
        constraints.extend(sides(of.frame, origin, bounds).map(|constraint| NamedConstraint {
            name: name.clone(),
            constraint: Constraint::RelativePose(constraint),
        }));
    }
    Ok(constraints)
}

/// How a region that is fixed in the world lies wholly outside of the bounds of an object's root, in words.
fn outside_root_bounds(robot: &Robot, part: PartIndex, of: &Frame, bounds: [Option<(f64, f64)>; 3]) -> Option<String> {
    let root = &robot.joints[robot.links[robot[part].root_link.at()].joint?.at()];
    let Source::Coordinates { q, .. } = root.source else { return None };
    if root.motion != JointType::FreeFlyer || root.parent.is_some() || of.joint.is_some() {
        return None;
    }
    let X_RF = root.parent_from_joint.inverse() * of.joint_from_frame;
    let R = DMat3::from_quat(X_RF.rotation);
    (0..3).find_map(|axis| {
        // The region's extent along an axis of the root; endless where it is along an open axis of the region.
        let extent = (0..3).try_fold((X_RF.translation[axis], X_RF.translation[axis]), |(low, high), along| {
            let share = R.col(along)[axis];
            match bounds[along] {
                _ if share.abs() < 1e-12 => Some((low, high)),
                Some((a, b)) => Some((low + (share * a).min(share * b), high + (share * a).max(share * b))),
                None => None,
            }
        });
        let ((low, high), (least, most)) = (extent?, (robot.space.lower[q + axis], robot.space.upper[q + axis]));
        (low > most || high < least).then(|| {
            let (object, name) = (quoted(&robot[part].name), ["x", "y", "z"][axis]);
            format!("the region has {name} from {low} to {high}, and `root_bounds` of `{object}` are [{least}, {most}] there")
        })
    })
}

/// A point between bounds: above the lower ones in the frame's axes, and in axes that are turned round above the upper ones.
fn sides(of: Frame, point: Frame, bounds: [Option<(f64, f64)>; 3]) -> impl Iterator<Item = RelativePose> {
    let corner = |side: fn((f64, f64)) -> f64| DVec3::from_array(bounds.map(|bounds| bounds.map_or(0.0, side)));
    let (lower, upper) = (corner(|bounds| bounds.0), corner(|bounds| bounds.1));
    let rows = |axes: [bool; 3]| -> Rows {
        std::array::from_fn(|row| (row < 3 && axes[row] && bounds[row].is_some()).then_some(Row::Inequality))
    };
    let sides = [
        (Pose::from_translation(lower), rows([true; 3])),
        (Pose::from_parts(upper, DQuat::from_rotation_z(PI)), rows([true, true, false])),
        (Pose::from_parts(upper, DQuat::from_rotation_x(PI)), rows([false, false, true])),
    ];
    sides.into_iter().filter(|(_, rows)| rows.iter().any(Option::is_some)).map(move |(at, rows)| RelativePose {
        a: of.then(&at),
        b: point,
        rows,
        reference: Reference::Identity,
    })
}

/// `hands`: `"empty"`, `"any"`, or what each gripper holds.
pub(super) fn hands(
    item: &Item<'_>,
    robot: &Robot,
    graph: &GraphOptions,
) -> Result<(Vec<(GripperIndex, Holding)>, OtherHands), SceneError> {
    if item.is_string() {
        let is_hand = |gripper: &GripperIndex| {
            robot[robot.links[robot.grippers[gripper.at()].link.at()].part].kind == PartKind::Robot
        };
        return match item.string()? {
            "empty" => {
                let hands = graph.grippers.iter().copied().filter(is_hand).map(|gripper| (gripper, Holding::Nothing));
                Ok((hands.collect(), OtherHands::AsAsked))
            }
            "any" => Ok((Vec::new(), OtherHands::Anything)),
            word => Err(item
                .error(format!("`{}` is neither \"empty\" nor \"any\"", quoted(word)))
                .hint("or a table of grippers: \"part/gripper\" = \"object\"")),
        };
    }
    let mut hands = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let known = || graph.grippers.iter().map(|gripper| robot.grippers[gripper.at()].name.as_str());
        let gripper = robot.gripper(name).filter(|gripper| graph.grippers.contains(gripper));
        let gripper = gripper.ok_or_else(|| {
            item.error("there is no gripper of this name in the graph").hint(did_you_mean(name, known()))
        })?;
        hands.push((gripper, holding(&item, robot, graph)?));
    }
    Ok((hands, OtherHands::AsAsked))
}

/// What a gripper holds: `"empty"`, `"any"`, an object, or one of its handles.
fn holding(item: &Item<'_>, robot: &Robot, graph: &GraphOptions) -> Result<Holding, SceneError> {
    let name = item.string()?;
    match name {
        "empty" => return Ok(Holding::Nothing),
        "any" => return Ok(Holding::Anything),
        _ => {}
    }
    if let Some(handle) = robot.handle(name).filter(|h| graph.objects.iter().any(|o| o.handles.contains(h))) {
        return Ok(Holding::Handle(handle));
    }
    Ok(Holding::Object(object(name, item, robot, graph)?))
}

/// `held`: objects that some gripper holds.
pub(super) fn held(item: &Item<'_>, robot: &Robot, graph: &GraphOptions) -> Result<Vec<PartIndex>, SceneError> {
    item.list()?.iter().map(|item| object(item.string()?, item, robot, graph)).collect()
}

/// An object with a handle.
fn object(name: &str, item: &Item<'_>, robot: &Robot, graph: &GraphOptions) -> Result<PartIndex, SceneError> {
    let can_be_held = || graph.objects.iter().filter(|object| !object.handles.is_empty());
    let found = can_be_held().find(|object| robot[object.part].name == name);
    found.map(|object| object.part).ok_or_else(|| {
        let known = can_be_held().map(|object| robot[object.part].name.as_str());
        item.error(format!("there is no object `{}` with a handle", quoted(name))).hint(did_you_mean(name, known))
    })
}
