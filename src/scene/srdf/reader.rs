//! The state of reading one SRDF, and the checks of names that all its elements share.

use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::xml::Xml;
use foliate_components::robot::model::Model;
use roxmltree::Node;
use std::collections::HashSet;

pub(crate) struct Reader<'a, 'i> {
    pub(crate) xml: &'a Xml<'i>,
    pub(crate) model: &'a mut Model,
    pub(crate) warnings: &'a mut Vec<SceneError>,
    /// Names of grippers, handles and surfaces so far.
    pub(crate) names: HashSet<(&'static str, &'a str)>,
}

impl<'a> Reader<'a, '_> {
    pub(crate) fn warn(&mut self, node: Node<'_, '_>, message: impl Into<String>, hint: &str) {
        self.warnings.push(self.xml.error(node, message).hint(hint));
    }

    /// The name of a document: present, and new among its kind.
    pub(crate) fn name(&mut self, node: Node<'a, '_>, kind: &'static str) -> Result<&'a str, SceneError> {
        let name = self.xml.attribute(node, "name")?;
        match self.names.insert((kind, name)) {
            true => Ok(name),
            false => Err(self.xml.error(node, format!("a {kind} of this name exists already"))),
        }
    }

    /// The link that a document is on.
    pub(crate) fn link(&self, node: Node<'a, '_>) -> Result<String, SceneError> {
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
