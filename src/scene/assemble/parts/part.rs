//! One robot, object or environment, read and placed.

use crate::scene::assemble::names::frame::one_of;
use crate::scene::assemble::parts::auto_keys::Auto;
use crate::scene::assemble::parts::documents::{documents, part_name};
use crate::scene::assemble::parts::shape;
use crate::scene::assemble::scene::{Loader, PartSource};
use crate::scene::assemble::timing::PartRates;
use crate::scene::mesh::formats::triangles::UpAxis;
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use crate::scene::sources::source::{OpenError, Opened, Origin, open};
use crate::scene::urdf::read;
use foliate_components::Pose;
use foliate_components::pose::pose_to_array;
use foliate_components::robot::model::{JointKind, Model};
use foliate_components::robot::{JointType, PartKind, PartPlacement, RootJoint};
use glam::DQuat;
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::PI;

/// Rounding allowed beyond a limit, radians or metres.
const SLACK: f64 = 1e-9;

/// A part, ready to be composed.
pub(crate) struct LoadedPart<'f> {
    pub model: Model,
    pub placement: PartPlacement,
    pub source: PartSource,
    /// The part's `ignore`, to be read once links have numbers.
    pub ignore: Option<Item<'f>>,
    /// The part's `avoided_by`, likewise.
    pub avoided_by: Option<Item<'f>>,
    /// The part's rate limits, likewise.
    pub rates: PartRates<'f>,
    /// What is to be found in it.
    pub auto: Auto<'f>,
    /// Where the part stands in the scene file.
    pub item: Item<'f>,
}

pub(crate) fn read<'f>(item: &Item<'f>, loader: &mut Loader<'_>) -> Result<LoadedPart<'f>, SceneError> {
    let mut keys = item.keys()?;
    let name = part_name(&keys.required("name")?)?;
    let kind = kind(&keys.required("kind")?)?;
    let up_axis = match keys.optional("mesh_up_axis") {
        Some(item) => one_of(&item, &UpAxis::WORDS)?,
        None => UpAxis::AsWritten,
    };
    let urdf_file = urdf_or_shape(&mut keys, name, up_axis, loader)?;
    let base = urdf_file.file.base();
    let mut context = read::Context::new(&mut loader.meshes, &base, up_axis, &mut loader.warnings);
    context.may_be_frames = kind == PartKind::Environment;
    let mut model = read::read(&urdf_file.label, &urdf_file.text, &mut context)?;
    let mut sha256 = context.sha256;
    sha256.insert("urdf".into(), urdf_file.file.sha256.clone());
    let srdf_file = keys.optional("srdf").map(|item| opened(&item, loader)).transpose()?;
    if let Some(file) = &srdf_file {
        crate::scene::srdf::read::read(
            &file.label,
            &file.text,
            &mut model,
            &mut loader.warnings,
            &loader.packages.limits().stop,
        )?;
        sha256.insert("srdf".into(), file.file.sha256.clone());
    }
    documents(&mut keys, &mut model)?;
    let auto = Auto::read(&mut keys, kind)?;
    let placement = placement(&mut keys, name, kind, &model)?;
    let joint_values = match kind {
        PartKind::Environment => freeze(&mut keys, &mut model, placement.mimic_follows)?,
        PartKind::Robot | PartKind::Object => Vec::new(),
    };
    let (ignore, avoided_by) = (keys.optional("ignore"), keys.optional("avoided_by"));
    if let Some(item) = avoided_by.as_ref().filter(|_| kind != PartKind::Environment) {
        return Err(item
            .error("only an environment says who avoids it")
            .hint("`ignore` of the scene names single pairs"));
    }
    let rates = PartRates::of(&mut keys);
    keys.finish()?;
    let srdf = srdf_file.map(|opened| opened.file);
    let urdf = urdf_file.file;
    let source = PartSource { name: name.to_owned(), urdf, srdf, sha256, mesh_up_axis: up_axis, joint_values };
    Ok(LoadedPart { model, placement, source, ignore, avoided_by, rates, auto, item: item.clone() })
}

fn kind(item: &Item<'_>) -> Result<PartKind, SceneError> {
    let kinds = [("robot", PartKind::Robot), ("object", PartKind::Object), ("environment", PartKind::Environment)];
    one_of(item, &kinds)
}

/// The URDF of a part, or what its `shape` makes of one.
fn urdf_or_shape(
    keys: &mut Keys<'_>,
    name: &str,
    up_axis: UpAxis,
    loader: &mut Loader<'_>,
) -> Result<Opened, SceneError> {
    match (keys.optional("shape"), keys.optional("urdf")) {
        (Some(item), None) => shape::opened(&item, name, up_axis, loader),
        (None, Some(item)) => opened(&item, loader),
        (Some(item), Some(_)) => Err(item.error("the part has a `urdf` as well").hint("give one of them")),
        (None, None) => Err(keys.error("key `urdf` is missing").hint("or give a `shape`")),
    }
}

fn opened(item: &Item<'_>, loader: &mut Loader<'_>) -> Result<Opened, SceneError> {
    let url = item.string()?;
    let opened = open(url, &loader.base, loader.packages).map_err(|error| match error {
        OpenError::Name(message, hint) => item.error(format!("`{}`: {message}", quoted(url))).hint(hint),
        OpenError::File(error) => error,
    })?;
    if let Origin::File(path) | Origin::Xacro(path, _) = &opened.file.origin {
        loader.sums.insert(path.clone(), opened.file.sha256.clone());
    }
    Ok(opened)
}

fn placement(keys: &mut Keys<'_>, name: &str, kind: PartKind, model: &Model) -> Result<PartPlacement, SceneError> {
    let roots = [("fixed", RootJoint::Fixed), ("freeflyer", RootJoint::FreeFlyer), ("planar", RootJoint::Planar)];
    let root = match keys.optional("root") {
        Some(item) => {
            let root = one_of(&item, &roots)?;
            if kind == PartKind::Environment && root != RootJoint::Fixed {
                return Err(item.error("an environment never moves").hint("make it an object, or leave `root` out"));
            }
            root
        }
        None if kind == PartKind::Object => RootJoint::FreeFlyer,
        None => RootJoint::Fixed,
    };
    let world_from_root = match keys.optional("pose") {
        Some(item) if root == RootJoint::FreeFlyer => {
            let hint = "start and goals say where it is";
            return Err(item.error("a part with a free-flyer root has no `pose`").hint(hint));
        }
        Some(item) => item.pose()?,
        None => Pose::identity(),
    };
    let mimic_follows = match keys.optional("mimic") {
        Some(item) => one_of(&item, &[("follow", true), ("free", false)])?,
        None => true,
    };
    Ok(PartPlacement {
        name: name.to_owned(),
        kind,
        root,
        world_from_root,
        mimic_follows,
        root_bounds: root_bounds(keys, root)?,
        joint_bounds: joint_bounds(keys, model)?,
    })
}

fn root_bounds(keys: &mut Keys<'_>, root: RootJoint) -> Result<Vec<(f64, f64)>, SceneError> {
    let Some(item) = keys.optional("root_bounds") else { return Ok(Vec::new()) };
    let (wanted, words) = match root {
        RootJoint::Fixed => return Err(item.error("a fixed root has no bounds")),
        RootJoint::FreeFlyer => (3..=3, "3"),
        RootJoint::Planar => (2..=3, "2 or 3"),
    };
    let list = item.list()?;
    if !wanted.contains(&list.len()) {
        return Err(item.error(format!("wants {words} pairs of lower and upper, got {}", list.len())));
    }
    let bounds: Vec<(f64, f64)> = list.iter().map(Item::bounds).collect::<Result<_, _>>()?;
    // Motions turn the shorter way, which stays within bounds as long as these span no more than half a turn.
    match (root, bounds.get(2)) {
        (RootJoint::Planar, Some((low, high))) if high - low > PI => {
            let hint = "leave them out where it may turn freely";
            Err(item.error("the bounds of theta span more than half a turn").hint(hint))
        }
        _ => Ok(bounds),
    }
}

/// `"part/root_joint" = [x, y, theta]`, or a pose, in `[locked]`: the root's bounds become equal, so that it never moves. The same for
/// planar and floating joints of models.
pub(crate) fn lock_roots(keys: &mut Keys<'_>, parts: &mut [LoadedPart<'_>]) -> Result<(), SceneError> {
    let Some(item) = keys.optional("locked") else { return Ok(()) };
    for (name, item) in item.keys()?.entries() {
        lock_joint(name, &item, parts)?;
        let part = name.strip_suffix("/root_joint");
        let found = parts.iter_mut().find(|p| Some(p.placement.name.as_str()) == part);
        let Some(placement) = found.map(|p| &mut p.placement) else { continue };
        let values = match placement.root {
            RootJoint::Fixed => continue,
            RootJoint::Planar => item.array::<3>("x y theta")?.to_vec(),
            RootJoint::FreeFlyer => pose_to_array(&item.pose()?).to_vec(),
        };
        let beyond = |(x, (low, high)): (&f64, &(f64, f64))| !(low..=high).contains(&x);
        if values.iter().zip(&placement.root_bounds).any(beyond) {
            return Err(item.error(format!("is outside the `root_bounds` of `{}`", placement.name)));
        }
        placement.root_bounds = values.into_iter().map(|x| (x, x)).collect();
    }
    Ok(())
}

/// The bounds of a planar or floating joint of a model become equal.
fn lock_joint(name: &str, item: &Item<'_>, parts: &mut [LoadedPart<'_>]) -> Result<(), SceneError> {
    let Some((part, joint)) = name.split_once('/') else { return Ok(()) };
    let Some(part) = parts.iter_mut().find(|p| p.placement.name == part) else { return Ok(()) };
    let Some(kind) = part.model.joints.iter().find(|j| j.name == joint).map(|j| j.kind) else { return Ok(()) };
    let (motion, values) = match kind {
        JointKind::Planar => (JointType::Planar, item.array::<3>("x y theta")?.to_vec()),
        JointKind::Floating => (JointType::FreeFlyer, pose_to_array(&item.pose()?).to_vec()),
        _ => return Ok(()),
    };
    let bounds = &mut part.placement.joint_bounds;
    for (axis, value) in motion.axes().iter().zip(values) {
        let name = format!("{joint}/{axis}");
        if bounds.iter().any(|(known, low, high)| *known == name && !(*low..=*high).contains(&value)) {
            return Err(item.error(format!("is outside the `joint_bounds` of `{name}`")));
        }
        bounds.retain(|(known, ..)| *known != name);
        bounds.push((name, value, value));
    }
    Ok(())
}

fn joint_bounds(keys: &mut Keys<'_>, model: &Model) -> Result<Vec<(String, f64, f64)>, SceneError> {
    let Some(item) = keys.optional("joint_bounds") else { return Ok(Vec::new()) };
    let mut bounds = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let (low, high) = item.bounds()?;
        match number_of(name, model) {
            Some("theta") if high - low > PI => {
                let hint = "leave them out where it may turn freely";
                return Err(item.error("the bounds of theta span more than half a turn").hint(hint));
            }
            Some(_) => {}
            None => drop(joint_of(&item, name, model)?),
        }
        bounds.push((name.to_owned(), low, high));
    }
    Ok(bounds)
}

/// The axis that a key names of a planar or floating joint: `joint/x`.
fn number_of<'n>(name: &'n str, model: &Model) -> Option<&'n str> {
    let (joint, axis) = name.rsplit_once('/')?;
    let kind = model.joints.iter().find(|j| j.name == joint)?.kind;
    let axes: &[&str] = match kind {
        JointKind::Planar => &["x", "y", "theta"],
        JointKind::Floating => &["x", "y", "z"],
        _ => &[],
    };
    axes.contains(&axis).then_some(axis)
}

/// The joint of one coordinate that a key names.
fn joint_of(item: &Item<'_>, name: &str, model: &Model) -> Result<usize, SceneError> {
    let scalar = |kind| matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic);
    let found = model.joints.iter().position(|j| j.name == name && scalar(j.kind));
    let names = model.joints.iter().filter(|j| scalar(j.kind)).map(|j| j.name.as_str());
    found.ok_or_else(|| item.error("no joint of one coordinate has this name").hint(did_you_mean(name, names)))
}

/// What `values` gives to an environment's joints, by number.
fn values<'f>(
    keys: &mut Keys<'f>,
    model: &Model,
    mimic_follows: bool,
) -> Result<BTreeMap<usize, (f64, Item<'f>)>, SceneError> {
    let mut given = BTreeMap::new();
    let Some(item) = keys.optional("values") else { return Ok(given) };
    for (name, item) in item.keys()?.entries() {
        let index = joint_of(&item, name, model)?;
        if let Some((leader, ..)) = model.joints[index].mimic.as_ref().filter(|_| mimic_follows) {
            let leader = quoted(leader);
            let hint = format!("give the value of `{leader}`, or write mimic = \"free\"");
            return Err(item.error(format!("this joint follows `{leader}`")).hint(hint));
        }
        given.insert(index, (item.number()?, item));
    }
    Ok(given)
}

/// Makes all joints of an environment fixed, at 0 or at the value that `values` gives. Returns these values.
fn freeze(keys: &mut Keys<'_>, model: &mut Model, mimic_follows: bool) -> Result<Vec<(String, f64)>, SceneError> {
    let given = values(keys, model, mimic_follows)?;
    let by_name: HashMap<&str, usize> = model.joints.iter().enumerate().map(|(i, j)| (j.name.as_str(), i)).collect();
    // The joint that one follows, and its own value.
    let value = |index: usize| {
        let (mut at, mut factor, mut offset) = (index, 1.0, 0.0);
        // The URDF reader has refused cycles; the loop is bounded all the same.
        for _ in 0..model.joints.len() {
            match &model.joints[at].mimic {
                Some((leader, multiplier, shift)) if mimic_follows => {
                    offset += factor * shift;
                    factor *= multiplier;
                    at = by_name.get(leader.as_str()).copied().unwrap_or(at);
                }
                _ => break,
            }
        }
        (at, factor * given.get(&at).map_or(0.0, |(value, _)| *value) + offset)
    };
    let values: Vec<(usize, f64)> = (0..model.joints.len()).map(value).collect();
    for (joint, &(leader, value)) in model.joints.iter().zip(&values) {
        let (low, high) = joint.limits;
        if let Some((_, item)) = given.get(&leader).filter(|_| value < low - SLACK || value > high + SLACK) {
            let message =
                format!("joint `{}` is then at {value}, outside its limits [{low}, {high}]", quoted(&joint.name));
            return Err(item.error(message));
        }
    }
    let named = given.iter().map(|(&index, &(value, _))| (model.joints[index].name.clone(), value)).collect();
    for (joint, (_, value)) in model.joints.iter_mut().zip(values) {
        let moved = match joint.kind {
            JointKind::Revolute | JointKind::Continuous => {
                Pose::from_rotation(DQuat::from_axis_angle(joint.axis, value))
            }
            JointKind::Prismatic => Pose::from_translation(joint.axis * value),
            JointKind::Planar | JointKind::Floating | JointKind::Fixed => Pose::identity(),
        };
        joint.parent_from_joint *= moved;
        (joint.kind, joint.mimic) = (JointKind::Fixed, None);
    }
    Ok(named)
}
