//! `[graph]`: who may hold what, where things may lie.

use crate::scene::assemble::constraints::constraint;
use crate::scene::assemble::graph::{hands, rests, written};
use crate::scene::assemble::names::frame;
use crate::scene::assemble::names::frame::{Context, one_of};
use crate::scene::assemble::names::locked::{Locks, scalar_joint, within};
use crate::scene::assemble::parts::auto::Ways;
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::Pose;
use foliate_components::problem::{GraphOptions, JointRest, ObjectOptions, RestingJoint, RestingPlane, Rule};
use foliate_components::robot::{
    GripperIndex, HandleIndex, LinkIndex, PartIndex, PartKind, Robot, RootJoint, SurfaceIndex,
};

/// Gap between an object and its support where a scene gives none, metres.
const PLACEMENT_MARGIN: f64 = 1e-3;
/// Lift before a transfer where a scene gives none, metres.
const PREPLACEMENT_DISTANCE: f64 = 0.05;
/// Most grasps of a table.
const GRASPS: usize = 100_000;

/// Reads the table; `ways` says which gripper may hold which handle where the scene does not.
pub(crate) fn read(
    keys: &mut Keys<'_>,
    robot: &Robot,
    start: &[f64],
    (locks, ways): (&Locks, Option<Ways>),
) -> Result<GraphOptions, SceneError> {
    let graph = keys.optional("graph");
    let mut options = GraphOptions {
        grippers: (0..robot.grippers.len() as u32).map(GripperIndex).collect(),
        objects: objects(robot),
        supports: supports(robot),
        placement_margin: PLACEMENT_MARGIN,
        preplacement_distance: PREPLACEMENT_DISTANCE,
        grasps: ways.map(|ways| found_grasps(&ways, robot)),
        ..GraphOptions::default()
    };
    let mut graph = graph.map(|item| item.keys()).transpose()?;
    if let Some(item) = graph.as_mut().and_then(|keys| keys.optional("resting_joints")) {
        options.resting_joints = resting_joints(&item, robot, locks)?;
    }
    options.locked = locks.at_start(robot, start, &options.resting_joints);
    options.constraints = constraint::read(keys, &Context::new(robot, start, &options.locked))?;
    let Some(mut keys) = graph else { return Ok(options) };
    if let Some(item) = keys.optional("grippers") {
        options.grippers = names(&item, |i| gripper(i, robot))?;
    }
    if let Some(item) = keys.optional("supports") {
        options.supports = names(&item, |i| surface(i, robot))?;
    }
    if let Some(item) = keys.optional("objects") {
        for (name, item) in item.keys()?.entries() {
            object(name, &item, robot, &mut options.objects)?;
        }
    }
    if let Some(item) = keys.optional("grasps") {
        options.grasps = Some(grasps(&item, robot)?);
    }
    for item in keys.optional("rules").map_or(Ok(Vec::new()), |i| i.list())? {
        options.rules.push(rule(&item, robot)?);
    }
    if let Some(item) = keys.optional("placement_margin") {
        options.placement_margin = item.distance()?;
    }
    options.rests = rests::read(&mut keys)?;
    if let Some(item) = keys.optional("preplacement_distance") {
        options.preplacement_distance = item.distance()?;
    }
    if let Some(item) = keys.optional("hands") {
        options.hands = hands::read(&item, robot, &options.locked, |item, name| named_gripper(item, name, robot))?;
    }
    options.approach = hands::approach(&mut keys)?;
    options.approach_line = hands::approach_line(&mut keys)?;
    hands::approach_lines(&mut keys, robot, &mut options)?;
    options.lift = hands::lift(&mut keys)?;
    written::read(&mut keys, robot, &mut options)?;
    keys.finish()?;
    Ok(options)
}

/// `resting_joints = { "part/joint" = 0.0 or "stays" }`: they move only while a handle beyond them is held.
fn resting_joints(item: &Item<'_>, robot: &Robot, locks: &Locks) -> Result<Vec<RestingJoint>, SceneError> {
    let mut resting = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let joint = scalar_joint(&item, name, robot)?;
        if locks.names(joint) {
            return Err(item.error("is locked as well").hint("a joint either never moves or moves when it is held"));
        }
        let rest = match item.is_string() {
            true => one_of(&item, &[("stays", JointRest::Stays)])?,
            false => JointRest::At(within(&item, joint, robot)?),
        };
        resting.push(RestingJoint { joint, rest });
    }
    Ok(resting)
}

/// Every object part, with all its handles and surfaces.
fn objects(robot: &Robot) -> Vec<ObjectOptions> {
    (0..robot.parts.len())
        .filter(|&p| robot.parts[p].kind == PartKind::Object)
        .map(|p| ObjectOptions {
            part: PartIndex(p as u32),
            handles: on_part(p, robot, robot.handles.iter().map(|h| h.link)).map(HandleIndex).collect(),
            surfaces: match robot.parts[p].root {
                // It lies on nothing: its surfaces carry others.
                RootJoint::Fixed => Vec::new(),
                _ => on_part(p, robot, robot.surfaces.iter().map(|s| s.link)).map(SurfaceIndex).collect(),
            },
            plane: None,
        })
        .collect()
}

/// Every surface of environments and of furniture (objects with a fixed root).
fn supports(robot: &Robot) -> Vec<SurfaceIndex> {
    let carries = |s: &usize| {
        let part = &robot.parts[robot.links[robot.surfaces[*s].link.at()].part.at()];
        part.kind == PartKind::Environment || (part.kind == PartKind::Object && part.root == RootJoint::Fixed)
    };
    (0..robot.surfaces.len()).filter(carries).map(|s| SurfaceIndex(s as u32)).collect()
}

/// Numbers of the documents that are on a part.
fn on_part(part: usize, robot: &Robot, links: impl Iterator<Item = LinkIndex>) -> impl Iterator<Item = u32> {
    links.enumerate().filter(move |(_, link)| robot.links[link.at()].part.at() == part).map(|(i, _)| i as u32)
}

/// A list of names, each at most once.
fn names<T: PartialEq>(
    item: &Item<'_>,
    find: impl Fn(&Item<'_>) -> Result<T, SceneError>,
) -> Result<Vec<T>, SceneError> {
    let mut found = Vec::new();
    for item in item.list()? {
        let index = find(&item)?;
        if found.contains(&index) {
            return Err(item.error("is named a second time"));
        }
        found.push(index);
    }
    Ok(found)
}

fn unknown<'a>(item: &Item<'_>, what: &str, name: &str, known: impl Iterator<Item = &'a str>) -> SceneError {
    item.error(format!("there is no {what} `{}`", quoted(name))).hint(did_you_mean(name, known))
}

fn gripper(item: &Item<'_>, robot: &Robot) -> Result<GripperIndex, SceneError> {
    named_gripper(item, item.string()?, robot)
}

fn named_gripper(item: &Item<'_>, name: &str, robot: &Robot) -> Result<GripperIndex, SceneError> {
    let known = || robot.grippers.iter().map(|g| g.name.as_str());
    robot.gripper(name).ok_or_else(|| unknown(item, "gripper", name, known()))
}

fn surface(item: &Item<'_>, robot: &Robot) -> Result<SurfaceIndex, SceneError> {
    let name = item.string()?;
    let known = || robot.surfaces.iter().map(|s| s.name.as_str());
    robot.surface(name).ok_or_else(|| unknown(item, "surface", name, known()))
}

fn handle(item: &Item<'_>, robot: &Robot) -> Result<HandleIndex, SceneError> {
    let name = item.string()?;
    let known = || robot.handles.iter().map(|h| h.name.as_str());
    robot.handle(name).ok_or_else(|| unknown(item, "handle", name, known()))
}

/// `[graph.objects.NAME]`: which of an object's documents take part. Names may leave the part out.
fn object(name: &str, item: &Item<'_>, robot: &Robot, objects: &mut [ObjectOptions]) -> Result<(), SceneError> {
    let known = objects.iter().map(|o| robot.parts[o.part.at()].name.as_str()).collect::<Vec<_>>();
    let Some(position) = known.iter().position(|n| *n == name) else {
        return Err(item.error("there is no object of this name").hint(did_you_mean(name, known)));
    };
    let object = &mut objects[position];
    let mut keys = item.keys()?;
    let own = |item: &Item<'_>, names: Vec<(u32, &str)>| -> Result<u32, SceneError> {
        let wanted = item.string()?;
        let found = names.iter().find(|(_, n)| *n == wanted || n.strip_prefix(name) == Some(&format!("/{wanted}")));
        let known = names.iter().map(|(_, n)| *n);
        found.map(|(i, _)| *i).ok_or_else(|| unknown(item, "document of this object", wanted, known))
    };
    if let Some(item) = keys.optional("handles") {
        let all = || object.handles.iter().map(|h| (h.0, robot.handles[h.at()].name.as_str())).collect();
        object.handles = names(&item, |i| own(i, all()).map(HandleIndex))?;
    }
    if let Some(item) = keys.optional("surfaces") {
        let all = || object.surfaces.iter().map(|s| (s.0, robot.surfaces[s.at()].name.as_str())).collect();
        object.surfaces = names(&item, |i| own(i, all()).map(SurfaceIndex))?;
    }
    if let Some(item) = keys.optional("plane") {
        if robot.parts[object.part.at()].root == RootJoint::Fixed {
            return Err(item.error("an object with a fixed root lies nowhere"));
        }
        object.plane = Some(plane(&item, robot)?);
    }
    keys.finish()
}

/// `{ pose = …, frame = …, on = "part/link" }`: the plane in the world, the frame of the object's root link that lies in it at
/// rest, and whose top the plane is.
fn plane(item: &Item<'_>, robot: &Robot) -> Result<RestingPlane, SceneError> {
    let mut keys = item.keys()?;
    let plane = RestingPlane {
        world_from_plane: keys.required("pose")?.pose()?,
        object_from_frame: keys.optional("frame").map_or(Ok(Pose::identity()), |i| i.pose())?,
        on: keys.optional("on").map(|i| still_link(&i, robot)).transpose()?,
    };
    keys.finish()?;
    Ok(plane)
}

/// A link that is fixed in the world, as a plane is.
fn still_link(item: &Item<'_>, robot: &Robot) -> Result<LinkIndex, SceneError> {
    let link = frame::link(item, robot)?;
    match robot.links[link.at()].joint {
        None => Ok(link),
        Some(_) => Err(item
            .error(format!("`{}` moves", quoted(&robot.links[link.at()].name)))
            .hint("a plane stands still; what objects lie on and moves along has surfaces")),
    }
}

/// Grasps that were found.
fn found_grasps(ways: &[(String, Vec<String>)], robot: &Robot) -> Vec<(GripperIndex, HandleIndex)> {
    let of = |(gripper, handles): &(String, Vec<String>)| {
        let gripper = robot.gripper(gripper);
        let handles: Vec<HandleIndex> = handles.iter().filter_map(|handle| robot.handle(handle)).collect();
        gripper.into_iter().flat_map(move |gripper| handles.clone().into_iter().map(move |handle| (gripper, handle)))
    };
    ways.iter().flat_map(of).collect()
}

/// `grasps = { "robot/gripper" = ["object/handle", …] }`.
fn grasps(item: &Item<'_>, robot: &Robot) -> Result<Vec<(GripperIndex, HandleIndex)>, SceneError> {
    let mut all = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let gripper = named_gripper(&item, name, robot)?;
        all.extend(names(&item, |i| handle(i, robot))?.into_iter().map(|h| (gripper, h)));
        if all.len() > GRASPS {
            return Err(item.error(format!("there are more than {GRASPS} grasps")));
        }
    }
    Ok(all)
}

/// `{ when = { "robot/gripper" = "object/handle" or "empty" }, allow = … }`.
fn rule(item: &Item<'_>, robot: &Robot) -> Result<Rule, SceneError> {
    let mut keys = item.keys()?;
    let mut rule = Rule { grasps: Vec::new(), allowed: keys.required("allow")?.boolean()? };
    for (name, item) in keys.required("when")?.keys()?.entries() {
        let gripper = named_gripper(&item, name, robot)?;
        let held = match item.string()? {
            "empty" => None,
            _ => Some(handle(&item, robot)?),
        };
        rule.grasps.push((gripper, held));
    }
    keys.finish()?;
    Ok(rule)
}
