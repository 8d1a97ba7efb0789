//! Reads an SRDF document into the model that it belongs to, one kind of element after the other.

use crate::scene::reading::error::SceneError;
use crate::scene::reading::xml::{Xml, elements};
use crate::scene::srdf::known::KNOWN;
use crate::scene::srdf::reader::Reader;
use foliate_components::robot::model::Model;
use foliate_systems::events::StopSignal;
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
    reader.group_states(root)?;
    reader.end_effectors(root)?;
    KNOWN.tell_unknown(&xml, root, warnings);
    Ok(())
}
