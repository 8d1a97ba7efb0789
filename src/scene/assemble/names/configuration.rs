//! `start`, `goal`, `locked`: configurations by name or as whole vectors.

use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::pose::{pose_from_array, pose_to_array};
use foliate_components::robot::{Joint, JointIndex, JointType, Part, Robot, Source};
use std::collections::{HashMap, HashSet};

/// Names of the coordinates in order: `part/joint`, for a free-flyer root `part/x` … `part/qw`, for a planar root
/// `part/x`, `part/y`, `part/theta`; a free or planar joint inside a part has its own name in between.
#[must_use]
pub fn coordinate_names(robot: &Robot) -> Vec<String> {
    let mut names = Vec::with_capacity(robot.space.size());
    for (index, joint) in robot.joints.iter().enumerate() {
        if !matches!(joint.source, Source::Coordinates { .. }) {
            continue;
        }
        let part = &robot.parts[joint.part.at()];
        let is_root = part.root_joint == Some(JointIndex(index as u32));
        let prefix = if is_root { &part.name } else { &joint.name };
        match joint.motion.axes() {
            [] => names.push(joint.name.clone()),
            axes => names.extend(axes.iter().map(|axis| format!("{prefix}/{axis}"))),
        }
    }
    names
}

/// Refuses parts of which two coordinates, or two joints, have one name: a joint `x` beside a root that moves in x.
pub(crate) fn refuse_twins(robot: &Robot, items: &[Item<'_>]) -> Result<(), SceneError> {
    let joints = robot.joints.iter().map(|joint| joint.name.clone());
    for names in [coordinate_names(robot), joints.collect()] {
        let mut seen = HashSet::new();
        let Some(twin) = names.iter().find(|name| !seen.insert(name.as_str())) else { continue };
        let part =
            robot.parts.iter().position(|p| twin.strip_prefix(&p.name).is_some_and(|rest| rest.starts_with('/')));
        let Some(item) = part.and_then(|part| items.get(part)) else { continue };
        let message = format!("a joint and the root are both called `{}`", quoted(twin));
        return Err(item.error(message).hint("give the joint another name in the URDF, or the part a fixed root"));
    }
    Ok(())
}

/// Whether a joint has one coordinate of its own.
pub(crate) fn has_number(joint: &Joint) -> bool {
    matches!(joint.source, Source::Coordinates { .. }) && joint.motion.axes().is_empty()
}

/// The joint of a name, where it has several coordinates: a root that moves, or a planar or floating joint of a model.
pub(crate) fn joint_of_several(name: &str, robot: &Robot) -> Option<JointIndex> {
    robot.joint(name).filter(|joint| !robot.joints[joint.at()].motion.axes().is_empty())
}

/// `coordinates`: the names that whole vectors of this scene are written in, as places in a configuration.
pub(crate) fn order(keys: &mut Keys<'_>, robot: &Robot) -> Result<Option<Vec<usize>>, SceneError> {
    let Some(item) = keys.optional("coordinates") else { return Ok(None) };
    let names = coordinate_names(robot);
    let place: HashMap<&str, usize> = names.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
    let (mut order, mut seen) = (Vec::new(), HashSet::new());
    for item in item.list()? {
        let name = item.string()?;
        let known = names.iter().map(String::as_str);
        let index = place.get(name).copied().ok_or_else(|| {
            item.error(format!("there is no coordinate `{}`", quoted(name))).hint(did_you_mean(name, known))
        })?;
        if !seen.insert(index) {
            return Err(item.error(format!("`{name}` is named a second time")));
        }
        order.push(index);
    }
    match names.iter().enumerate().find(|(i, _)| !seen.contains(i)) {
        Some((_, name)) => Err(item.error(format!("coordinate `{name}` is missing")).hint("name every coordinate")),
        None => Ok(Some(order)),
    }
}

/// Reads configurations of one robot.
pub(crate) struct Reader<'a> {
    pub robot: &'a Robot,
    pub locked: &'a [(JointIndex, f64)],
    pub order: Option<&'a [usize]>,
}

impl Reader<'_> {
    /// The start: joints that are not named stand at their locked value, or at 0; objects must be named.
    pub fn start(&self, item: &Item<'_>) -> Result<Vec<f64>, SceneError> {
        let mut q = self.robot.space.neutral();
        let mut known = vec![false; q.len()];
        for &(joint, value) in self.locked {
            if let Source::Coordinates { q: i, .. } = self.robot.joints[joint.at()].source {
                (q[i], known[i]) = (value, true);
            }
        }
        let space = &self.robot.space;
        for i in (0..q.len()).filter(|&i| space.is_immovable(i..i + 1)) {
            (q[i], known[i]) = (space.lower[i], true);
        }
        self.configuration(item, &mut q, &mut known)?;
        self.check_locked(item, &q)?;
        for (i, name) in coordinate_names(self.robot).iter().enumerate().filter(|(i, _)| !known[*i]) {
            let (low, high) = (self.robot.space.lower[i], self.robot.space.upper[i]);
            let is_root = self.is_root(i);
            if is_root || !(low <= 0.0 && 0.0 <= high) {
                let why = if is_root { "" } else { ", and 0 is out of its bounds" };
                return Err(item.error(format!("says nothing about `{name}`{why}")));
            }
        }
        Ok(q)
    }

    /// A whole goal: what it does not name stands as in the start.
    pub fn whole_goal(&self, item: &Item<'_>, start: &[f64]) -> Result<Vec<f64>, SceneError> {
        let mut q = start.to_vec();
        let mut known = vec![false; q.len()];
        self.configuration(item, &mut q, &mut known)?;
        self.check_locked(item, &q)?;
        Ok(q)
    }

    /// A whole vector, or a table of names.
    fn configuration(&self, item: &Item<'_>, q: &mut [f64], known: &mut [bool]) -> Result<(), SceneError> {
        match item.is_table() {
            true => self.by_name(item, q, known)?,
            false => self.vector(item, q, known)?,
        }
        self.normalise(item, q)
    }

    fn vector(&self, item: &Item<'_>, q: &mut [f64], known: &mut [bool]) -> Result<(), SceneError> {
        let Some(order) = self.order else {
            return Err(item.error("a whole vector needs the names of its numbers").hint("give `coordinates = […]`"));
        };
        let numbers = item.numbers()?;
        if numbers.len() != order.len() {
            return Err(item.error(format!("wants {} numbers, as `coordinates`, got {}", order.len(), numbers.len())));
        }
        for (&i, x) in order.iter().zip(numbers) {
            (q[i], known[i]) = (x, true);
        }
        Ok(())
    }

    /// Names of joints and coordinates, of parts with their root's pose or a named configuration.
    fn by_name(&self, item: &Item<'_>, q: &mut [f64], known: &mut [bool]) -> Result<(), SceneError> {
        let names = coordinate_names(self.robot);
        let place: HashMap<&str, usize> = names.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
        let entries = item.keys()?.entries();
        // Named configurations first: what is named beside them holds.
        for (name, item) in entries.iter().filter(|(_, item)| item.is_string()) {
            let part = self.robot.parts.iter().find(|p| p.name == *name);
            let part = part.ok_or_else(|| self.unknown(item, name, &names))?;
            self.group_state(part, item, &place, q, known)?;
        }
        for (name, item) in entries.iter().filter(|(_, item)| !item.is_string()) {
            if let Some(&i) = place.get(name) {
                (q[i], known[i]) = (item.number()?, true);
            } else if let Some(part) = self.robot.parts.iter().find(|p| p.name == *name) {
                self.root(part, item, q, known)?;
            } else if let Some(joint) = joint_of_several(name, self.robot) {
                self.several(joint, item, q, known)?;
            } else {
                return Err(self.unknown(item, name, &names));
            }
        }
        Ok(())
    }

    fn unknown(&self, item: &Item<'_>, name: &str, names: &[String]) -> SceneError {
        let parts = self.robot.parts.iter().map(|p| p.name.as_str());
        let hint = did_you_mean(name, names.iter().map(String::as_str).chain(parts));
        item.error("there is no coordinate or part of this name").hint(hint)
    }

    /// The numbers of a part's named configuration.
    pub fn named_configuration(&self, part: &str, item: &Item<'_>) -> Result<Vec<(usize, f64)>, SceneError> {
        let names = coordinate_names(self.robot);
        let place: HashMap<&str, usize> = names.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
        let found = self.robot.parts.iter().find(|p| p.name == part);
        let part = found.ok_or_else(|| self.unknown(item, part, &names))?;
        let mut q = self.robot.space.neutral();
        let mut known = vec![false; q.len()];
        self.group_state(part, item, &place, &mut q, &mut known)?;
        Ok((0..q.len()).filter(|&i| known[i]).map(|i| (i, q[i])).collect())
    }

    fn group_state(
        &self,
        part: &Part,
        item: &Item<'_>,
        place: &HashMap<&str, usize>,
        q: &mut [f64],
        known: &mut [bool],
    ) -> Result<(), SceneError> {
        let name = item.string()?;
        let Some(state) = part.group_states.iter().find(|s| s.name == name) else {
            let states = part.group_states.iter().map(|s| s.name.as_str());
            let message = format!("`{}` has no configuration `{}`", part.name, quoted(name));
            return Err(item.error(message).hint(did_you_mean(name, states)));
        };
        if let Some(contradiction) = &state.contradiction {
            let message =
                format!("configuration `{}` of `{}` contradicts itself: {contradiction}", quoted(name), part.name);
            return Err(item.error(message).hint("name joints, or mend the SRDF"));
        }
        for (joint, value) in &state.values {
            if let Some(&i) = place.get(format!("{}/{joint}", part.name).as_str()) {
                (q[i], known[i]) = (*value, true);
            }
        }
        Ok(())
    }

    /// A part's root: a pose in the world (free-flyer), or x, y, θ in its plane (planar).
    fn root(&self, part: &Part, item: &Item<'_>, q: &mut [f64], known: &mut [bool]) -> Result<(), SceneError> {
        let Some(joint) = part.root_joint else {
            return Err(item.error(format!("the root of `{}` does not move", part.name)));
        };
        self.several(joint, item, q, known)
    }

    /// All numbers of a planar or floating joint.
    fn several(&self, joint: JointIndex, item: &Item<'_>, q: &mut [f64], known: &mut [bool]) -> Result<(), SceneError> {
        let joint = &self.robot.joints[joint.at()];
        let Source::Coordinates { q: i, .. } = joint.source else { return Ok(()) };
        match joint.motion {
            JointType::Planar => q[i..i + 3].copy_from_slice(&item.array::<3>("x y theta")?),
            _ => q[i..i + 7].copy_from_slice(&pose_to_array(&item.pose()?)),
        }
        let size = joint.motion.configuration_size();
        known[i..i + size].iter_mut().for_each(|k| *k = true);
        Ok(())
    }

    /// Quaternions are scaled to one; what is far from one is a slip.
    fn normalise(&self, item: &Item<'_>, q: &mut [f64]) -> Result<(), SceneError> {
        for joint in &self.robot.joints {
            let Source::Coordinates { q: i, .. } = joint.source else { continue };
            if joint.motion != JointType::FreeFlyer {
                continue;
            }
            let mut numbers = [0.0; 7];
            numbers.copy_from_slice(&q[i..i + 7]);
            let length = numbers[3..].iter().map(|x| x * x).sum::<f64>().sqrt();
            let pose = pose_from_array(numbers).filter(|_| (length - 1.0).abs() < 1e-3).ok_or_else(|| {
                item.error(format!("the quaternion of `{}` has length {length:.4}", joint.name))
                    .hint("order is x y z w; a rotation has length 1")
            })?;
            q[i..i + 7].copy_from_slice(&pose_to_array(&pose));
        }
        Ok(())
    }

    /// The value at which a coordinate is locked, if it is.
    pub fn locked_value(&self, coordinate: usize) -> Option<f64> {
        let at = |joint: JointIndex| match self.robot.joints[joint.at()].source {
            Source::Coordinates { q, .. } => q == coordinate,
            Source::Follows { .. } => false,
        };
        self.locked.iter().find(|(joint, _)| at(*joint)).map(|(_, value)| *value)
    }

    /// Locked joints stand at their values.
    fn check_locked(&self, item: &Item<'_>, q: &[f64]) -> Result<(), SceneError> {
        for &(joint, value) in self.locked {
            let joint = &self.robot.joints[joint.at()];
            if let Source::Coordinates { q: i, .. } = joint.source
                && (q[i] - value).abs() > 1e-9
            {
                let message = format!("`{}` is {} here, and locked at {value}", joint.name, q[i]);
                return Err(item.error(message).hint("a locked joint never moves"));
            }
        }
        let space = &self.robot.space;
        let moved = |i: &usize| space.is_immovable(*i..*i + 1) && (q[*i] - space.lower[*i]).abs() > 1e-9;
        match (0..q.len()).find(moved) {
            Some(i) => {
                let (name, value) = (&coordinate_names(self.robot)[i], q[i]);
                let message = format!("`{name}` is {value} here, and never moves from {}", space.lower[i]);
                let own = self.robot.narrowed.iter().find(
                    |n| matches!(self.robot.joints[n.leader.at()].source, Source::Coordinates { q, .. } if q == i),
                );
                Err(item.error(message).hint(match own.map(|narrowed| narrowed.own) {
                    Some((low, high)) => format!(
                        "its own limits are [{low}, {high}], but the joints that follow it keep theirs nowhere else: mend a \
                         <limit> or the <mimic> in the URDF"
                    ),
                    None => "it is locked, or its bounds are equal".into(),
                }))
            }
            None => Ok(()),
        }
    }

    fn is_root(&self, coordinate: usize) -> bool {
        self.robot.parts.iter().filter_map(|p| p.root_joint).any(|j| {
            let joint = &self.robot.joints[j.at()];
            let Source::Coordinates { q, .. } = joint.source else { return false };
            (q..q + joint.motion.configuration_size()).contains(&coordinate)
        })
    }
}
