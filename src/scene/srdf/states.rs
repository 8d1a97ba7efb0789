//! Named configurations. Configuration tools name them per group, so that one name is there several times: all of them apply.

use super::{Reader, SceneError, elements, label, quoted};
use foliate_components::robot::model::GroupState;
use roxmltree::Node;
use std::collections::HashMap;

impl<'a> Reader<'a, '_> {
    pub(super) fn group_states(&mut self, root: Node<'a, '_>) -> Result<(), SceneError> {
        let mut places: HashMap<&str, usize> = HashMap::new();
        let mut lines: HashMap<(usize, String), u32> = HashMap::new();
        for node in elements(root, "group_state") {
            let name = self.xml.attribute(node, "name")?;
            let place = *places.entry(name).or_insert_with(|| {
                let state = GroupState { name: name.to_owned(), ..GroupState::default() };
                self.model.group_states.push(state);
                self.model.group_states.len() - 1
            });
            for (joint, value, line) in self.values(node)? {
                let state = &mut self.model.group_states[place];
                let first = *lines.entry((place, joint.clone())).or_insert(line);
                match state.values.iter().find(|(known, _)| *known == joint) {
                    None => state.values.push((joint, value)),
                    Some(&(_, known)) if known != value && state.contradiction.is_none() => {
                        let file = self.xml.file;
                        state.contradiction = Some(format!(
                            "joint `{}` is at {known} in {file}:{first} and at {value} in {file}:{line}",
                            quoted(&joint)
                        ));
                    }
                    Some(_) => {}
                }
            }
        }
        Ok(())
    }

    /// Joints, values and lines; joints of several values (roots) are left out.
    fn values(&mut self, node: Node<'a, '_>) -> Result<Vec<(String, f64, u32)>, SceneError> {
        let mut values = Vec::new();
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
                Some(name) => values.push((name.to_owned(), value, self.xml.line(joint))),
                None if written == "root_joint" => {}
                None => {
                    let message = format!("joint `{}` is not in the URDF", quoted(written));
                    self.warn(joint, format!("{message}; see {}", label(node)), "its value is left out");
                }
            }
        }
        Ok(values)
    }
}
