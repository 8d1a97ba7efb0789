//! `grippers`, `handles` and `surfaces` of a part that are `"auto"`: what `foliate new` would write, found when the scene is read.
//!
//! Numbers are rounded as a written scene has them, so that both scenes are the same problem.

use crate::scene::assemble::parts::part::LoadedPart;
use crate::scene::assemble::scene::Loader;
use crate::scene::reading::error::SceneError;
use crate::scene::reading::keys::Item;
use crate::scene::srdf::contact::check_polygons;
use crate::setup::grippers::{FoundGripper, declared, grippers, hands};
use crate::setup::handles::{FoundHandle, HandleSettings, Kinds, distinct, handles, no_grasp};
use crate::setup::objects::RigidObject;
use crate::setup::surfaces::{FoundSurface, level_faces, resting_faces};
use crate::setup::writing::numbers::{pose_as_written, rounded};
use foliate_components::Pose;
use foliate_components::robot::model::{GripperModel, HandleModel, SurfaceModel};
use foliate_components::robot::{PartKind, Robot, RootJoint};
use glam::DVec3;

/// Names of grippers, each with the names of the handles that it may hold.
pub(crate) type Ways = Vec<(String, Vec<String>)>;

/// Finds what parts leave to be found. Returns which gripper may hold which handle, where grippers of several sizes make that differ.
///
/// # Errors
/// What cannot be found, at the key that asks for it.
pub(crate) fn complete(parts: &mut [LoadedPart<'_>], loader: &Loader<'_>) -> Result<Option<Ways>, SceneError> {
    let look = |part: &LoadedPart<'_>| loader.packages.limits().reached(&part.placement.name);
    let wants_handles = parts.iter().any(|part| part.auto.handles.is_some());
    let mut found: Vec<(String, FoundGripper)> = Vec::new();
    for part in parts.iter_mut().filter(|part| part.placement.kind == PartKind::Robot) {
        look(part)?;
        let own = match &part.auto.grippers {
            Some(_) => found_grippers(part)?,
            None if wants_handles => declared_grippers(part)?,
            None => Vec::new(),
        };
        let name = part.placement.name.clone();
        found.extend(own.into_iter().map(|gripper| (format!("{name}/{}", gripper.name), gripper)));
    }
    for part in parts.iter_mut() {
        look(part)?;
        find_surfaces(part)?;
    }
    match wants_handles {
        true => find_handles(parts, &found, &look),
        false => Ok(None),
    }
}

/// A part's robot alone, its root at the origin.
fn alone(part: &LoadedPart<'_>, item: &Item<'_>) -> Result<Robot, SceneError> {
    let mut placement = part.placement.clone();
    (placement.root, placement.root_bounds, placement.world_from_root) =
        (RootJoint::Fixed, Vec::new(), Pose::identity());
    Robot::compose(&[(&part.model, placement)]).map_err(|error| item.error(error.to_string()))
}

/// Finds the grippers of a robot, and adds them to its model.
fn found_grippers(part: &mut LoadedPart<'_>) -> Result<Vec<FoundGripper>, SceneError> {
    let Some(item) = part.auto.grippers.clone() else { return Ok(Vec::new()) };
    let robot = alone(part, &item)?;
    let found = grippers(&robot, &[], &part.model.end_effectors).map_err(|error| item.error(error.to_string()))?;
    for gripper in &found {
        if part.model.grippers.iter().any(|known| known.name == gripper.name) {
            return Err(item.error(format!("the part has a gripper `{}` already", gripper.name)));
        }
        let link = robot.links[gripper.link.at()].name.as_str();
        part.model.grippers.push(GripperModel {
            name: gripper.name.clone(),
            link: link.split_once('/').map_or(link, |(_, own)| own).to_owned(),
            link_from_gripper: pose_as_written(&gripper.link_from_gripper),
            clearance: 0.0,
        });
    }
    Ok(found)
}

/// The grippers that documents declare, with the sizes of their hands.
fn declared_grippers(part: &LoadedPart<'_>) -> Result<Vec<FoundGripper>, SceneError> {
    if part.model.grippers.is_empty() {
        return Ok(Vec::new());
    }
    let robot = alone(part, &part.item)?;
    let hands = hands(&robot);
    let of_model = |gripper: &GripperModel| {
        declared(&robot, &hands, gripper).map_err(|why| {
            let hint = "list the handles of objects, or write `grippers = \"auto\"` instead";
            part.item
                .error(format!("gripper `{}` says no sizes for `handles = \"auto\"`: {why}", gripper.name))
                .hint(hint)
        })
    };
    part.model.grippers.iter().map(of_model).collect()
}

/// Adds the faces on which an object rests, or those of an environment that carry something.
fn find_surfaces(part: &mut LoadedPart<'_>) -> Result<(), SceneError> {
    let Some(item) = part.auto.surfaces.clone() else { return Ok(()) };
    let body = rigid(part, &item)?;
    let carries = part.placement.kind == PartKind::Environment || part.placement.root == RootJoint::Fixed;
    let found = match carries {
        true => level_faces(&body, &part.placement.world_from_root),
        false => resting_faces(&body),
    };
    if found.is_empty() {
        let (message, hint) = match (carries, body.is_ball()) {
            (true, _) => ("no face of it is level, convex and larger than 10 cm²", "list its surfaces"),
            (false, true) => ("a ball rests on no face", "give it a `plane` in [graph.objects]"),
            (false, false) => {
                ("it rests on none of its faces: its centre of mass is less than 6 mm inside of each", "")
            }
        };
        return Err(item.error(message).hint(hint));
    }
    for face in found {
        if part.model.surfaces.iter().any(|known| known.name == face.name) {
            return Err(item.error(format!("the part has a surface `{}` already", face.name)));
        }
        let surface = surface(&face, &body);
        check_polygons(&surface.points, &surface.polygons).map_err(|message| item.error(message))?;
        part.model.surfaces.push(surface);
    }
    Ok(())
}

fn surface(face: &FoundSurface, body: &RigidObject) -> SurfaceModel {
    let point = |p: &DVec3| DVec3::from_array(p.to_array().map(rounded));
    SurfaceModel {
        name: face.name.clone(),
        link: body.link.clone(),
        points: face.points.iter().map(point).collect(),
        polygons: vec![(0..face.points.len() as u32).collect()],
    }
}

/// Adds the handles of objects for all grippers.
fn find_handles(
    parts: &mut [LoadedPart<'_>],
    found: &[(String, FoundGripper)],
    look: &dyn Fn(&LoadedPart<'_>) -> Result<(), SceneError>,
) -> Result<Option<Ways>, SceneError> {
    let (names, grippers): (Vec<String>, Vec<FoundGripper>) = found.iter().cloned().unzip();
    let kinds = Kinds::of(&grippers);
    let mut ways: Ways = names.into_iter().map(|name| (name, Vec::new())).collect();
    for part in parts.iter_mut().filter(|part| part.placement.kind == PartKind::Object) {
        look(part)?;
        let full = |name: &str| format!("{}/{name}", part.placement.name);
        // Handles of documents are for every gripper.
        let written: Vec<String> = part.model.handles.iter().map(|handle| full(&handle.name)).collect();
        ways.iter_mut().for_each(|(_, names)| names.extend(written.iter().cloned()));
        let Some(item) = part.auto.handles.clone() else { continue };
        if grippers.is_empty() {
            let hint = "give a robot `grippers = \"auto\"`, or an SRDF that declares them";
            return Err(item.error("no robot of the scene has a gripper").hint(hint));
        }
        let object = rigid(part, &item)?;
        let settings = HandleSettings::default();
        let own = kinds.handles(|gripper| Ok::<_, SceneError>(handles(&object, &grippers[gripper], settings)))?;
        if own.is_empty() {
            return Err(item.error(no_grasp(&object, &grippers).to_string()));
        }
        own.iter().for_each(|(gripper, handle)| ways[*gripper].1.push(full(&handle.name)));
        for handle in distinct(&own) {
            if part.model.handles.iter().any(|known| known.name == handle.name) {
                return Err(item.error(format!("the part has a handle `{}` already", handle.name)));
            }
            part.model.handles.push(model(handle, &object));
        }
    }
    Ok(kinds.differ().then_some(ways))
}

fn model(handle: &FoundHandle, object: &RigidObject) -> HandleModel {
    HandleModel {
        name: handle.name.clone(),
        link: object.link.clone(),
        link_from_handle: pose_as_written(&handle.link_from_handle),
        clearance: rounded(handle.clearance),
        mask: handle.mask,
        mask_complement: handle.mask.map(|row| !row),
        approaching_direction: DVec3::X,
    }
}

/// A part as one rigid body.
fn rigid(part: &LoadedPart<'_>, item: &Item<'_>) -> Result<RigidObject, SceneError> {
    RigidObject::of(&part.placement.name, &part.model).map_err(|error| item.error(error.to_string()))
}
