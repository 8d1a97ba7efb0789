//! Named configurations. Configuration tools name them per group, so that one name is there several times: all of them apply.

use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::xml::{elements, label};
use crate::scene::srdf::reader::Reader;
use foliate_components::robot::model::GroupState;
use roxmltree::Node;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

impl<'a> Reader<'a, '_> {
    pub(super) fn group_states(&mut self, root: Node<'a, '_>) -> Result<(), SceneError> {
        let mut places: HashMap<&str, usize> = HashMap::new();
        let mut firsts: HashMap<(usize, String), (f64, u32)> = HashMap::new();
        let joints: HashSet<String> = self.model.joints.iter().map(|joint| joint.name.clone()).collect();
        for (count, node) in elements(root, "group_state").enumerate() {
            self.xml.look(count)?;
            let name = self.xml.attribute(node, "name")?;
            let place = *places.entry(name).or_insert_with(|| {
                let state = GroupState { name: name.to_owned(), ..GroupState::default() };
                self.model.group_states.push(state);
                self.model.group_states.len() - 1
            });
            for (joint, value, line) in self.values(node, &joints)? {
                let state = &mut self.model.group_states[place];
                match firsts.entry((place, joint)) {
                    Entry::Vacant(entry) => {
                        state.values.push((entry.key().1.clone(), value));
                        entry.insert((value, line));
                    }
                    Entry::Occupied(entry) => {
                        let &(known, first) = entry.get();
                        if known != value && state.contradiction.is_none() {
                            let (file, joint) = (self.xml.file, quoted(&entry.key().1));
                            state.contradiction = Some(format!(
                                "joint `{joint}` is at {known} in {file}:{first} and at {value} in {file}:{line}"
                            ));
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Joints, values and lines; joints of several values (roots) are left out.
    fn values(&mut self, node: Node<'a, '_>, joints: &HashSet<String>) -> Result<Vec<(String, f64, u32)>, SceneError> {
        let mut values = Vec::new();
        for (count, joint) in elements(node, "joint").enumerate() {
            self.xml.look(count)?;
            let written = self.xml.attribute(joint, "name")?;
            let text = self.xml.attribute(joint, "value")?;
            let value = match self.xml.numbers(joint, "attribute `value`", text)?[..] {
                [value] => value,
                _ => continue,
            };
            let known = |name: &str| joints.contains(name);
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
