//! SRDF: disabled pairs, named configurations, and the grippers, handles and contact surfaces of manipulation planning.
//!
//! The manipulation tags are those of the Humanoid Path Planner: frames are given in their link, by text
//! (`x y z  qw qx qy qz`) or by attributes (`xyz` with `rpy`, `wxyz` or `xyzw`); unknown tags are ignored.

mod contact;
mod frames;

pub(crate) use contact::check_polygons;
pub(crate) use frames::check_mask;

use super::error::{SceneError, did_you_mean, quoted};
use super::xml::{Xml, elements, label};
use foliate_components::robot::model::{GroupState, Model};
use roxmltree::Node;
use std::collections::{BTreeMap, HashSet};

/// Reads an SRDF into the model that it describes.
///
/// # Errors
/// The first thing that is wrong, with its line.
pub(crate) fn read(
    file: &str,
    text: &str,
    model: &mut Model,
    warnings: &mut Vec<SceneError>,
) -> Result<(), SceneError> {
    let xml = Xml::parse(file, text)?;
    let root = xml.document.root_element();
    if root.tag_name().name() != "robot" {
        return Err(xml.error(root, "is not the root of an SRDF").hint("an SRDF begins with <robot name=…>"));
    }
    let mut reader = Reader { xml: &xml, model, warnings, names: HashSet::new() };
    reader.model.has_srdf = true;
    for node in elements(root, "gripper") {
        let gripper = reader.gripper(node)?;
        reader.model.grippers.push(gripper);
    }
    for node in elements(root, "handle") {
        let handle = reader.handle(node)?;
        reader.model.handles.push(handle);
    }
    for node in elements(root, "contact") {
        let surface = reader.contact(node)?;
        reader.model.surfaces.push(surface);
    }
    reader.disabled_pairs(root)?;
    for node in elements(root, "group_state") {
        let state = reader.group_state(node)?;
        reader.model.group_states.push(state);
    }
    Ok(())
}

struct Reader<'a, 'i> {
    xml: &'a Xml<'i>,
    model: &'a mut Model,
    warnings: &'a mut Vec<SceneError>,
    /// Names of grippers, handles and surfaces so far.
    names: HashSet<(&'static str, &'a str)>,
}

impl<'a> Reader<'a, '_> {
    fn warn(&mut self, node: Node<'_, '_>, message: impl Into<String>, hint: &str) {
        self.warnings.push(self.xml.error(node, message).hint(hint));
    }

    /// The name of a document: present, and new among its kind.
    fn name(&mut self, node: Node<'a, '_>, kind: &'static str) -> Result<&'a str, SceneError> {
        let name = self.xml.attribute(node, "name")?;
        match self.names.insert((kind, name)) {
            true => Ok(name),
            false => Err(self.xml.error(node, format!("a {kind} of this name exists already"))),
        }
    }

    /// The link that a document is on.
    fn link(&self, node: Node<'a, '_>) -> Result<String, SceneError> {
        let element = self.xml.child(node, "link")?;
        if element.attribute("index").is_some() {
            return Err(self.xml.error(element, "attribute `index` is not supported").hint("name the link"));
        }
        let name = self.xml.attribute(element, "name")?;
        let links = || self.model.links.iter().map(|l| l.name.as_str());
        match links().any(|l| l == name) {
            true => Ok(name.to_owned()),
            false => Err(self
                .xml
                .error(element, format!("link `{}` is not in the URDF", quoted(name)))
                .hint(did_you_mean(name, links()))),
        }
    }

    fn disabled_pairs(&mut self, root: Node<'a, '_>) -> Result<(), SceneError> {
        let links: HashSet<&str> = self.model.links.iter().map(|l| l.name.as_str()).collect();
        let (mut pairs, mut unknown) = (Vec::new(), BTreeMap::new());
        for node in elements(root, "disable_collisions") {
            let (first, second) = (self.xml.attribute(node, "link1")?, self.xml.attribute(node, "link2")?);
            match [first, second].iter().find(|l| !links.contains(**l)) {
                Some(missing) => unknown.entry(*missing).or_insert((node, 0)).1 += 1,
                None => {
                    let reason = node.attribute("reason").unwrap_or("SRDF");
                    pairs.push((first.to_owned(), second.to_owned(), reason.to_owned()));
                }
            }
        }
        drop(links);
        self.model.disabled_pairs.extend(pairs);
        for (link, (node, times)) in unknown {
            let message = format!("link `{}` is not in the URDF ({times} pairs name it)", quoted(link));
            self.warn(node, message, "these pairs are left out");
        }
        Ok(())
    }

    /// A named configuration; joints of several values (roots) are left out.
    fn group_state(&mut self, node: Node<'a, '_>) -> Result<GroupState, SceneError> {
        let mut state = GroupState { name: self.xml.attribute(node, "name")?.to_owned(), values: Vec::new() };
        for joint in elements(node, "joint") {
            let written = self.xml.attribute(joint, "name")?;
            let text = self.xml.attribute(joint, "value")?;
            let value = match self.xml.numbers(joint, "attribute `value`", text)?[..] {
                [value] => value,
                _ => continue,
            };
            let known = |name: &str| self.model.joints.iter().any(|j| j.name == name);
            // Some files write the part in front: `baxter/head_pan`.
            let unprefixed = written.split_once('/').map(|(_, name)| name).filter(|name| known(name));
            match Some(written).filter(|name| known(name)).or(unprefixed) {
                Some(name) => state.values.push((name.to_owned(), value)),
                None if written == "root_joint" => {}
                None => {
                    let message = format!("joint `{}` is not in the URDF", quoted(written));
                    self.warn(joint, format!("{message}; see {}", label(node)), "its value is left out");
                }
            }
        }
        Ok(state)
    }
}
