//! SRDF: disabled pairs, named configurations, and the grippers, handles and contact surfaces of manipulation planning.
//!
//! The manipulation tags are those of the Humanoid Path Planner: frames are given in their link, by text
//! (`x y z  qw qx qy qz`) or by attributes (`xyz` with `rpy`, `wxyz` or `xyzw`); unknown tags are ignored.

mod contact;
mod disabled;
mod frames;
mod states;

pub(crate) use contact::check_polygons;
pub(crate) use frames::check_mask;

use super::error::{SceneError, did_you_mean, quoted};
use super::xml::{Xml, elements, label};
use foliate_components::robot::model::Model;
use foliate_systems::events::StopSignal;
use roxmltree::Node;
use std::collections::HashSet;

/// Reads an SRDF into the model that it describes.
///
/// # Errors
/// The first thing that is wrong, with its line.
pub(crate) fn read(
    file: &str,
    text: &str,
    model: &mut Model,
    warnings: &mut Vec<SceneError>,
    stop: &StopSignal,
) -> Result<(), SceneError> {
    let xml = Xml::parse(file, text, stop)?;
    let root = xml.document.root_element();
    if root.tag_name().name() != "robot" {
        return Err(xml.error(root, "is not the root of an SRDF").hint("an SRDF begins with <robot name=…>"));
    }
    let mut reader = Reader { xml: &xml, model, warnings, names: HashSet::new() };
    reader.model.has_srdf = true;
    for (count, node) in elements(root, "gripper").enumerate() {
        xml.look(count)?;
        let gripper = reader.gripper(node)?;
        reader.model.grippers.push(gripper);
    }
    for (count, node) in elements(root, "handle").enumerate() {
        xml.look(count)?;
        let handle = reader.handle(node)?;
        reader.model.handles.push(handle);
    }
    for (count, node) in elements(root, "contact").enumerate() {
        xml.look(count)?;
        let surface = reader.contact(node)?;
        reader.model.surfaces.push(surface);
    }
    reader.disabled_pairs(root)?;
    reader.default_pairs(root)?;
    reader.group_states(root)
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
}
