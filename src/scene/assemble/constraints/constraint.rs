//! `[[constraint]]`: constraints of the problem's own, by name.

use crate::scene::assemble::constraints::mass;
use crate::scene::assemble::names::frame::{Context, ReadFrame, box_bounds, frame, one_of, or_start};
use crate::scene::assemble::names::locked::scalar_joint;
use crate::scene::reading::error::SceneError;
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::Pose;
use foliate_components::constraint::{
    Constraint, Distance, Locked, LockedValue, Mask, Reference, Region, RelativePose, Row, Rows, Tilt,
};
use foliate_components::problem::NamedConstraint;
use foliate_components::robot::{Robot, Source};

/// Most constraints of a scene.
const CONSTRAINTS: usize = 1000;
/// Names of the six rows of a relative pose, for messages.
const ROWS: [&str; 6] = ["tx", "ty", "tz", "rx", "ry", "rz"];

pub(crate) fn read(keys: &mut Keys<'_>, context: &Context<'_>) -> Result<Vec<NamedConstraint>, SceneError> {
    let Some(item) = keys.optional("constraint") else { return Ok(Vec::new()) };
    let items = item.list()?;
    if items.len() > CONSTRAINTS {
        return Err(item.error(format!("there are more than {CONSTRAINTS} constraints")));
    }
    let mut constraints: Vec<NamedConstraint> = Vec::with_capacity(items.len());
    for item in &items {
        let mut keys = item.keys()?;
        let name = keys.required("name")?;
        if constraints.iter().any(|c| Ok(c.name.as_str()) == name.string()) {
            return Err(name.error("two constraints have this name"));
        }
        let name = name.string()?.to_owned();
        let constraint = kind(&mut keys, item, context)?;
        keys.finish()?;
        constraints.push(NamedConstraint { name, constraint });
    }
    Ok(constraints)
}

type Read = fn(&mut Keys<'_>, &Item<'_>, &Context<'_>) -> Result<Constraint, SceneError>;

fn kind(keys: &mut Keys<'_>, item: &Item<'_>, context: &Context<'_>) -> Result<Constraint, SceneError> {
    let kinds: [(&str, Read); 7] = [
        ("pose", pose),
        ("centre_of_mass", mass::centre),
        ("centre_of_mass_between", mass::between),
        ("distance", distance),
        ("tilt", tilt),
        ("region", region),
        ("joint", joint),
    ];
    one_of(&keys.required("kind")?, &kinds)?(keys, item, context)
}

/// `frame` and `to`, on different bodies.
fn two_frames(keys: &mut Keys<'_>, item: &Item<'_>, robot: &Robot) -> Result<(ReadFrame, ReadFrame), SceneError> {
    let moving = frame(&keys.required("frame")?, robot)?;
    let to = keys.optional("to").map_or(Ok(ReadFrame::world()), |item| frame(&item, robot))?;
    if moving.frame.joint == to.frame.joint {
        let hint = "without `to` it is the world; fixed joints make one body of links";
        return Err(item.error("`frame` and `to` are on one body, which always holds or never").hint(hint));
    }
    Ok((moving, to))
}

/// The value is part of frame A, so that rows are read in its axes and zero rows are zero there.
fn pose(keys: &mut Keys<'_>, item: &Item<'_>, context: &Context<'_>) -> Result<Constraint, SceneError> {
    let (b, a) = two_frames(keys, item, context.robot)?;
    let at_start = a.in_world(&context.bodies).inverse() * b.in_world(&context.bodies);
    let value =
        keys.optional("value").map_or(Ok(Pose::identity()), |item| or_start(&item, at_start, |item| item.pose()))?;
    let rows = rows(keys, item)?;
    let reference = if rows.contains(&Some(Row::Parameter)) { Reference::Argument(0) } else { Reference::Identity };
    Ok(Constraint::RelativePose(RelativePose { a: a.frame.then(&value), b: b.frame, rows, reference }))
}

/// `mask`, `parameter` and `at_least`; without `mask` every row that the others leave is zero.
fn rows(keys: &mut Keys<'_>, item: &Item<'_>) -> Result<Rows, SceneError> {
    let (mask, parameter, at_least) = (keys.optional("mask"), keys.optional("parameter"), keys.optional("at_least"));
    let flags = |item: &Option<Item<'_>>| item.as_ref().map_or(Ok([false; 6]), Item::mask);
    let (parameters, bounded) = (flags(&parameter)?, flags(&at_least)?);
    let zero = match &mask {
        Some(item) => item.mask()?,
        None => std::array::from_fn(|i| !parameters[i] && !bounded[i]),
    };
    let said = |i: usize| usize::from(zero[i]) + usize::from(parameters[i]) + usize::from(bounded[i]);
    if let Some(i) = (0..6).find(|&i| said(i) > 1) {
        return Err(item
            .error(format!("row {} is asked for twice", ROWS[i]))
            .hint("a row is zero, a parameter, or bounded"));
    }
    if (0..6).all(|i| said(i) == 0) {
        return Err(item.error("no row is asked for"));
    }
    if let (Some(item), true) = (&at_least, bounded[3..].contains(&true)) {
        return Err(item.error("only translations have a side").hint("bound tx, ty and tz"));
    }
    for (at, mask) in [(&mask, zero), (&parameter, std::array::from_fn(|i| zero[i] || parameters[i]))] {
        Mask(mask).of_grasp().map_err(|e| at.as_ref().unwrap_or(item).error(e.to_string()))?;
    }
    Ok(std::array::from_fn(|i| match () {
        () if zero[i] => Some(Row::Zero),
        () if parameters[i] => Some(Row::Parameter),
        () if bounded[i] => Some(Row::Inequality),
        () => None,
    }))
}

fn distance(keys: &mut Keys<'_>, item: &Item<'_>, context: &Context<'_>) -> Result<Constraint, SceneError> {
    let (b, a) = two_frames(keys, item, context.robot)?;
    let at_start = (b.in_world(&context.bodies).translation - a.in_world(&context.bodies).translation).length();
    let asked =
        [("length", Row::Zero, false), ("at_least", Row::Inequality, false), ("at_most", Row::Inequality, true)];
    let given: Vec<_> =
        asked.into_iter().filter_map(|(key, row, at_most)| Some((keys.optional(key)?, row, at_most))).collect();
    let [(length, row, at_most)] = &given[..] else {
        return Err(item.error("wants exactly one of `length`, `at_least` and `at_most`"));
    };
    let value = or_start(length, at_start, |item| item.distance())?;
    if value <= 0.0 {
        return Err(length
            .error("is not positive")
            .hint("for points that coincide take a `pose` with mask 1 1 1 0 0 0"));
    }
    Ok(Constraint::Distance(Distance { a: a.frame, b: b.frame, length: value, row: *row, at_most: *at_most }))
}

/// The z axes of two frames within an angle.
fn tilt(keys: &mut Keys<'_>, item: &Item<'_>, context: &Context<'_>) -> Result<Constraint, SceneError> {
    let (b, a) = two_frames(keys, item, context.robot)?;
    let angle = keys.required("within")?;
    let within = angle.number()?;
    if !(Tilt::LEAST..=Tilt::MOST).contains(&within) {
        return Err(angle
            .error(format!("is not between {} radians and a right angle", Tilt::LEAST))
            .hint("an axis that may not tilt at all is a `pose` with mask 0 0 0 1 1 0"));
    }
    Ok(Constraint::Tilt(Tilt { a: a.frame, b: b.frame, within }))
}

/// The origin of a frame within a box of another.
fn region(keys: &mut Keys<'_>, item: &Item<'_>, context: &Context<'_>) -> Result<Constraint, SceneError> {
    let (b, a) = two_frames(keys, item, context.robot)?;
    let free = (f64::NEG_INFINITY, f64::INFINITY);
    let bounds = box_bounds(keys, item)?.map(|bounds| bounds.unwrap_or(free));
    Ok(Constraint::Region(Region { a: a.frame, b: b.frame, bounds }))
}

fn joint(keys: &mut Keys<'_>, _: &Item<'_>, context: &Context<'_>) -> Result<Constraint, SceneError> {
    let item = keys.required("joint")?;
    let joint = scalar_joint(&item, item.string()?, context.robot)?;
    if context.locked.iter().any(|(locked, _)| *locked == joint) {
        return Err(item.error("is locked already"));
    }
    let at_start = match context.robot.joints[joint.at()].source {
        Source::Coordinates { q, .. } => context.start[q],
        Source::Follows { .. } => 0.0,
    };
    let item = keys.required("value")?;
    let value = match item.is_string() {
        true => one_of(&item, &[("start", LockedValue::Fixed(at_start)), ("stays", LockedValue::Argument(0))])?,
        false => LockedValue::Fixed(crate::scene::assemble::names::locked::within(&item, joint, context.robot)?),
    };
    Ok(Constraint::Locked(Locked { joint, value }))
}
