//! `gripper`, `handle`, `surface` and masks of a `[[part]]`: what a scene adds to the SRDF of a part, or changes in it.

use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use crate::scene::srdf::contact::check_polygons;
use crate::scene::srdf::frames::check_mask;
use foliate_components::Pose;
use foliate_components::robot::model::{GripperModel, HandleModel, Model, SurfaceModel};
use glam::DVec3;

pub(crate) fn part_name<'f>(item: &Item<'f>) -> Result<&'f str, SceneError> {
    let name = item.string()?;
    match name.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.')) && name.len() <= 64 {
        true => Ok(name),
        false => Err(item.error("a part's name is at most 64 letters, digits, `_`, `-` and `.`")),
    }
}

/// `gripper`, `handle`, `surface`, `masks` and `mask_complements` of a part.
pub(crate) fn documents(keys: &mut Keys<'_>, model: &mut Model) -> Result<(), SceneError> {
    for item in keys.optional("gripper").map_or(Ok(Vec::new()), |i| i.list())? {
        let gripper = gripper(&item, model)?;
        model.grippers.push(gripper);
    }
    for item in keys.optional("handle").map_or(Ok(Vec::new()), |i| i.list())? {
        let handle = handle(&item, model)?;
        model.handles.push(handle);
    }
    for item in keys.optional("surface").map_or(Ok(Vec::new()), |i| i.list())? {
        let surface = surface(&item, model)?;
        model.surfaces.push(surface);
    }
    if let Some(item) = keys.optional("masks") {
        for (name, item) in item.keys()?.entries() {
            let mask = legal_mask(&item)?;
            let handle = handle_of(&item, name, model)?;
            (handle.mask, handle.mask_complement) = (mask, mask.map(|m| !m));
        }
    }
    if let Some(item) = keys.optional("mask_complements") {
        for (name, item) in item.keys()?.entries() {
            handle_of(&item, name, model)?.mask_complement = item.mask()?;
        }
    }
    Ok(())
}

fn legal_mask(item: &Item<'_>) -> Result<[bool; 6], SceneError> {
    let mask = item.mask()?;
    check_mask(mask).map(|()| mask).map_err(|m| item.error(m).hint("free one rotation, all of them, or none"))
}

fn handle_of<'m>(item: &Item<'_>, name: &str, model: &'m mut Model) -> Result<&'m mut HandleModel, SceneError> {
    let names: Vec<String> = model.handles.iter().map(|h| h.name.clone()).collect();
    match model.handles.iter_mut().find(|h| h.name == name) {
        Some(handle) => Ok(handle),
        None => Err(item
            .error("no handle of this part has this name")
            .hint(did_you_mean(name, names.iter().map(String::as_str)))),
    }
}

/// `name` and `link` of a document.
fn name_and_link(
    keys: &mut Keys<'_>,
    model: &Model,
    mut taken: impl Iterator<Item = String>,
) -> Result<(String, String), SceneError> {
    let item = keys.required("name")?;
    let name = item.string()?;
    if taken.any(|t| t == name) {
        return Err(item.error(format!("`{}` exists already", quoted(name))).hint("perhaps in the SRDF"));
    }
    let item = match (keys.optional("link"), model.links.as_slice()) {
        (Some(item), _) => item,
        // Which one is meant is clear.
        (None, [only]) => return Ok((name.to_owned(), only.name.clone())),
        (None, _) => return Err(keys.error("key `link` is missing")),
    };
    let link = item.string()?;
    if !model.links.iter().any(|l| l.name == link) {
        let links = model.links.iter().map(|l| l.name.as_str());
        return Err(item.error(format!("link `{}` does not exist", quoted(link))).hint(did_you_mean(link, links)));
    }
    Ok((name.to_owned(), link.to_owned()))
}

fn gripper(item: &Item<'_>, model: &Model) -> Result<GripperModel, SceneError> {
    let mut keys = item.keys()?;
    let (name, link) = name_and_link(&mut keys, model, model.grippers.iter().map(|g| g.name.clone()))?;
    let gripper = GripperModel {
        name,
        link,
        link_from_gripper: keys.optional("pose").map_or(Ok(Pose::identity()), |i| i.pose())?,
        clearance: keys.optional("clearance").map_or(Ok(0.0), |i| i.distance())?,
    };
    keys.finish()?;
    Ok(gripper)
}

fn handle(item: &Item<'_>, model: &Model) -> Result<HandleModel, SceneError> {
    let mut keys = item.keys()?;
    let (name, link) = name_and_link(&mut keys, model, model.handles.iter().map(|h| h.name.clone()))?;
    let mask = keys.optional("mask").map_or(Ok([true; 6]), |i| legal_mask(&i))?;
    let approaching_direction = match keys.optional("approaching_direction") {
        Some(item) => {
            let direction = DVec3::from_array(item.array("a direction")?);
            direction.try_normalize().ok_or_else(|| item.error("a direction has a length"))?
        }
        None => DVec3::X,
    };
    let handle = HandleModel {
        name,
        link,
        link_from_handle: keys.optional("pose").map_or(Ok(Pose::identity()), |i| i.pose())?,
        clearance: keys.optional("clearance").map_or(Ok(0.0), |i| i.distance())?,
        mask,
        mask_complement: keys.optional("mask_complement").map_or(Ok(mask.map(|m| !m)), |i| i.mask())?,
        approaching_direction,
    };
    keys.finish()?;
    Ok(handle)
}

fn surface(item: &Item<'_>, model: &Model) -> Result<SurfaceModel, SceneError> {
    let mut keys = item.keys()?;
    let (name, link) = name_and_link(&mut keys, model, model.surfaces.iter().map(|s| s.name.clone()))?;
    let points = keys.required("points")?.list()?;
    let points: Vec<DVec3> =
        points.iter().map(|p| p.array("x y z").map(DVec3::from_array)).collect::<Result<_, _>>()?;
    let item = keys.required("polygons")?;
    let mut polygons = Vec::new();
    for polygon in item.list()? {
        let mut indices = Vec::new();
        for number in polygon.list()? {
            match number.number()? {
                x if x >= 0.0 && x.fract() == 0.0 && (x as usize) < points.len() => indices.push(x as u32),
                x => return Err(number.error(format!("{x} is no index of the {} points", points.len()))),
            }
        }
        polygons.push(indices);
    }
    if polygons.is_empty() {
        return Err(item.error("is empty"));
    }
    check_polygons(&points, &polygons).map_err(|message| item.error(message))?;
    keys.finish()?;
    Ok(SurfaceModel { name, link, points, polygons })
}
