//! The joints of a URDF, and the tree that they make of its links.

use super::tree;
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::xml::{Xml, elements};
use crate::scene::urdf::range::{Range, meant, meant_velocity};
use crate::scene::urdf::soft_limits;
use crate::scene::urdf::values::origin;
use foliate_components::robot::model::{JointKind, JointModel, Model};
use glam::DVec3;
use roxmltree::Node;
use std::collections::HashMap;

/// Reads all joints into the model, whose links are known. Of joints that will stand still ranges are of no interest.
pub(super) fn read(
    xml: &Xml<'_>,
    root: Node<'_, '_>,
    model: &mut Model,
    (stand_still, warnings): (bool, &mut Vec<SceneError>),
) -> Result<(), SceneError> {
    let nodes: Vec<_> = elements(root, "joint").collect();
    let links: HashMap<&str, usize> = model.links.iter().enumerate().map(|(i, l)| (l.name.as_str(), i)).collect();
    let mut by_name = HashMap::new();
    let mut joints = Vec::with_capacity(nodes.len());
    let mut soft = Vec::new();
    for (index, &node) in nodes.iter().enumerate() {
        xml.look(index)?;
        let name = xml.attribute(node, "name")?;
        if let Some(first) = by_name.insert(name, index) {
            let line = xml.line(nodes[first]);
            return Err(xml
                .error(node, "a joint of this name exists already")
                .hint(format!("the first is at line {line}")));
        }
        let (joint, remark) = joint(xml, node, name, &links)?;
        warnings.extend(remark.filter(|_| !stand_still));
        soft.extend(soft_limits::narrower(node, &joint).filter(|_| !stand_still));
        joints.push(joint);
    }
    warnings.extend(soft_limits::remark(xml, &soft));
    tree::check(xml, root, &nodes, &joints, model)?;
    tree::check_mimics(xml, &nodes, &mut joints, &by_name, warnings)?;
    model.joints = joints;
    Ok(())
}

fn joint(
    xml: &Xml<'_>,
    node: Node<'_, '_>,
    name: &str,
    links: &HashMap<&str, usize>,
) -> Result<(JointModel, Option<SceneError>), SceneError> {
    let kind = kind(xml, node)?;
    let limit = xml.optional_child(node, "limit")?;
    let axis = axis(xml, node, kind)?;
    let Range { kind, limits, remark } = range(xml, node, limit, kind)?;
    let remark = remark.map(|(message, hint)| xml.error(limit.unwrap_or(node), message).hint(hint));
    let joint = JointModel {
        name: name.to_owned(),
        kind,
        parent: link(xml, node, "parent", links)?,
        child: link(xml, node, "child", links)?,
        parent_from_joint: origin(xml, node)?,
        axis,
        limits,
        velocity_limit: velocity(xml, limit)?,
        mimic: mimic(xml, node)?,
    };
    Ok((joint, remark))
}

fn kind(xml: &Xml<'_>, node: Node<'_, '_>) -> Result<JointKind, SceneError> {
    Ok(match xml.attribute(node, "type")? {
        "fixed" => JointKind::Fixed,
        "revolute" => JointKind::Revolute,
        "continuous" => JointKind::Continuous,
        "prismatic" => JointKind::Prismatic,
        "planar" => JointKind::Planar,
        "floating" => JointKind::Floating,
        other => {
            let kinds = ["fixed", "revolute", "continuous", "prismatic", "planar", "floating"];
            let message = format!("`{}` is no type of joint", quoted(other));
            return Err(xml.error(node, message).hint(did_you_mean(other, kinds)));
        }
    })
}

fn link(xml: &Xml<'_>, node: Node<'_, '_>, end: &str, links: &HashMap<&str, usize>) -> Result<usize, SceneError> {
    let element = xml.child(node, end)?;
    let name = xml.attribute(element, "link")?;
    links.get(name).copied().ok_or_else(|| {
        xml.error(element, format!("link `{}` does not exist", quoted(name))).hint(did_you_mean(name, in_order(links)))
    })
}

/// Names in the order of what they number: a map's own order is another in every process.
fn in_order<'a>(numbered: &HashMap<&'a str, usize>) -> impl Iterator<Item = &'a str> {
    let mut names: Vec<(usize, &str)> = numbered.iter().map(|(&name, &number)| (number, name)).collect();
    names.sort_unstable();
    names.into_iter().map(|(_, name)| name)
}

fn axis(xml: &Xml<'_>, node: Node<'_, '_>, kind: JointKind) -> Result<DVec3, SceneError> {
    let Some(element) = xml.optional_child(node, "axis")? else { return Ok(DVec3::X) };
    let axis = DVec3::from_array(xml.vector(element, "xyz")?.unwrap_or([1.0, 0.0, 0.0]));
    match (axis.try_normalize(), kind) {
        (Some(unit), _) => Ok(unit),
        // Fixed and floating joints turn about nothing; exporters write 0 0 0 there.
        (None, JointKind::Fixed | JointKind::Floating) => Ok(DVec3::X),
        (None, _) => Err(xml.error(element, "an axis has a length").hint("give a direction, such as 0 0 1")),
    }
}

fn range(xml: &Xml<'_>, node: Node<'_, '_>, limit: Option<Node<'_, '_>>, kind: JointKind) -> Result<Range, SceneError> {
    if !matches!(kind, JointKind::Revolute | JointKind::Prismatic) {
        return Ok(Range { kind, limits: (f64::NEG_INFINITY, f64::INFINITY), remark: None });
    }
    let Some(limit) = limit else {
        return Err(xml.error(node, "<limit> is missing").hint("give limits, or make a revolute joint `continuous`"));
    };
    let (lower, upper) = (xml.number(limit, "lower")?, xml.number(limit, "upper")?);
    if lower.is_none() && upper.is_none() {
        let remark =
            ("has neither `lower` nor `upper`: the joint stays at 0".to_owned(), "give it a range, or make it fixed");
        return Ok(Range { kind, limits: (0.0, 0.0), remark: Some(remark) });
    }
    let (lower, upper) = (lower.unwrap_or(0.0), upper.unwrap_or(0.0));
    match lower <= upper {
        true => Ok(meant(kind, (lower, upper))),
        false => Err(xml.error(limit, format!("the lower limit {lower} is above the upper limit {upper}"))),
    }
}

fn velocity(xml: &Xml<'_>, limit: Option<Node<'_, '_>>) -> Result<Option<f64>, SceneError> {
    let Some(limit) = limit else { return Ok(None) };
    match xml.number(limit, "velocity")? {
        Some(v) if v < 0.0 => Err(xml.error(limit, format!("the velocity limit {v} is negative"))),
        velocity => Ok(meant_velocity(velocity)),
    }
}

fn mimic(xml: &Xml<'_>, node: Node<'_, '_>) -> Result<Option<(String, f64, f64)>, SceneError> {
    let Some(mimic) = xml.optional_child(node, "mimic")? else { return Ok(None) };
    let multiplier = xml.number(mimic, "multiplier")?.unwrap_or(1.0);
    let offset = xml.number(mimic, "offset")?.unwrap_or(0.0);
    Ok(Some((xml.attribute(mimic, "joint")?.to_owned(), multiplier, offset)))
}
