//! End effectors: groups of links that are hands.

use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::xml::elements;
use crate::scene::srdf::reader::Reader;
use foliate_components::robot::model::EndEffectorModel;
use roxmltree::Node;
use std::collections::{HashMap, HashSet};

impl<'a> Reader<'a, '_> {
    /// All `<end_effector>`. One without name, or whose parent is no link of the URDF, is left out with a warning.
    pub(super) fn end_effectors(&mut self, root: Node<'a, '_>) -> Result<(), SceneError> {
        let mut effectors = elements(root, "end_effector").peekable();
        if effectors.peek().is_none() {
            return Ok(());
        }
        let named = |node: Node<'a, '_>| Some((node.attribute("name")?, node));
        let groups: HashMap<&str, Node<'a, '_>> = elements(root, "group").filter_map(named).collect();
        let found = effectors
            .enumerate()
            .map(|(count, node)| {
                self.xml.look(count)?;
                let [name, parent_link, group] =
                    ["name", "parent_link", "group"].map(|key| node.attribute(key).unwrap_or_default().to_owned());
                if name.is_empty() || self.link_number(&parent_link).is_none() {
                    let message = match (name.as_str(), parent_link.as_str()) {
                        ("", _) => "attribute `name` is missing".to_owned(),
                        (_, "") => "attribute `parent_link` is missing".to_owned(),
                        (_, parent) => format!("its parent, link `{}`, is not in the URDF", quoted(parent)),
                    };
                    self.warn(node, message, "the end effector is left out");
                    return Ok(None);
                }
                Ok(Some(EndEffectorModel { name, parent_link, links: self.links_of(&group, &groups) }))
            })
            .collect::<Result<Vec<_>, SceneError>>()?;
        self.model.end_effectors = found.into_iter().flatten().collect();
        Ok(())
    }

    /// The links of a group: named ones, those that named joints move, those of chains and of groups in it. What the URDF does not
    /// have is left out.
    fn links_of(&self, group: &str, groups: &HashMap<&str, Node<'a, '_>>) -> Vec<String> {
        let (mut found, mut seen) = (Vec::new(), HashSet::new());
        let mut stack = vec![group.to_owned()];
        while let Some(name) = stack.pop() {
            let Some(node) = groups.get(name.as_str()).filter(|_| seen.insert(name.clone())) else { continue };
            for item in node.children().filter(Node::is_element) {
                let own = item.attribute("name").unwrap_or_default();
                match item.tag_name().name() {
                    "link" => found.extend(self.link_number(own)),
                    "joint" => found.extend(self.model.joints.iter().find(|j| j.name == own).map(|j| j.child)),
                    "chain" => found.extend(self.chain(item)),
                    "group" => stack.push(own.to_owned()),
                    _ => {}
                }
            }
        }
        let mut names: Vec<String> = Vec::new();
        for link in found {
            let name = &self.model.links[link].name;
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        names
    }

    /// The links from `tip_link` up to `base_link`, without the latter; none where it is not above.
    fn chain(&self, node: Node<'_, '_>) -> Vec<usize> {
        let end = |name: &str| node.attribute(name).and_then(|link| self.link_number(link));
        let (Some(base), Some(tip)) = (end("base_link"), end("tip_link")) else { return Vec::new() };
        let parent = |link: &usize| self.model.joints.iter().find(|j| j.child == *link).map(|j| j.parent);
        let above: Vec<usize> = std::iter::successors(Some(tip), parent).take(self.model.links.len()).collect();
        let end = above.iter().position(|link| *link == base);
        end.map_or_else(Vec::new, |end| above[..end].to_vec())
    }

    fn link_number(&self, name: &str) -> Option<usize> {
        self.model.links.iter().position(|link| link.name == name)
    }
}
