//! The tree of one model's links and joints, and which of its joints follow others.

use crate::pose::Pose;
use crate::robot::error::PartError;
use crate::robot::model::part_model::{JointKind, JointModel, Model};
use glam::DQuat;
use std::collections::HashMap;

/// The tree of a model: its root link, and below each link its joints in alphabetical order of names.
pub(crate) struct Tree {
    pub(crate) root: usize,
    pub(crate) children: Vec<Vec<usize>>,
}

impl Tree {
    pub(crate) fn of(model: &Model) -> Result<Self, PartError> {
        if model.links.is_empty() {
            return Err(PartError::NoLinks);
        }
        unique(PartError::DuplicateLink, model.links.iter().map(|l| l.name.as_str()))?;
        unique(PartError::DuplicateJoint, model.joints.iter().map(|j| j.name.as_str()))?;
        let mut children = vec![Vec::new(); model.links.len()];
        let mut is_child = vec![false; model.links.len()];
        for (index, joint) in model.joints.iter().enumerate() {
            if joint.parent >= model.links.len() || joint.child >= model.links.len() {
                return Err(PartError::NoSuchLink(joint.name.clone()));
            }
            if std::mem::replace(&mut is_child[joint.child], true) {
                let link = model.links[joint.child].name.clone();
                return Err(PartError::TwoParents { link, joint: joint.name.clone() });
            }
            children[joint.parent].push(index);
        }
        for joints in &mut children {
            joints.sort_by(|&a, &b| model.joints[a].name.cmp(&model.joints[b].name));
        }
        let mut roots = (0..model.links.len()).filter(|&l| !is_child[l]);
        let root = roots.next().ok_or(PartError::NoRoot)?;
        if let Some(second) = roots.next() {
            let (first, second) = (model.links[root].name.clone(), model.links[second].name.clone());
            return Err(PartError::TwoRoots { first, second });
        }
        let tree = Self { root, children };
        tree.refuse_cycles(model)?;
        Ok(tree)
    }

    /// With one root and one parent per link, a link that the root does not reach lies on a cycle.
    fn refuse_cycles(&self, model: &Model) -> Result<(), PartError> {
        let mut reached = vec![false; model.links.len()];
        let mut stack = vec![self.root];
        while let Some(link) = stack.pop() {
            reached[link] = true;
            stack.extend(self.children[link].iter().map(|&j| model.joints[j].child));
        }
        match reached.iter().position(|r| !r) {
            Some(link) => Err(PartError::Cycle(model.links[link].name.clone())),
            None => Ok(()),
        }
    }
}

fn unique<'a>(twice: fn(String) -> PartError, names: impl Iterator<Item = &'a str>) -> Result<(), PartError> {
    let mut seen = std::collections::HashSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(twice(name.into()));
        }
    }
    Ok(())
}

/// Whom a joint of a model follows, chains resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Follow {
    /// No joint: it has coordinates of its own.
    Nothing,
    /// A joint (by its number in the model) that has a coordinate of its own.
    Joint { leader: usize, multiplier: f64, offset: f64 },
    /// A fixed joint, so that it never moves either: the value at which it stands.
    Constant(f64),
}

/// Resolves `mimic` of all joints: chains end at a joint with a coordinate, or at a fixed one; cycles are refused.
pub(crate) fn follows(model: &Model, mimic_follows: bool) -> Result<Vec<Follow>, PartError> {
    let mut resolved: Vec<Option<Follow>> = vec![None; model.joints.len()];
    let by_name: HashMap<&str, usize> = model.joints.iter().enumerate().map(|(i, j)| (j.name.as_str(), i)).collect();
    let scalar = |kind| matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic);
    let mut walked_in = vec![usize::MAX; model.joints.len()];
    for index in 0..model.joints.len() {
        let mut chain = Vec::new();
        let mut at = index;
        // Towards the leader, up to the first joint that was visited before.
        let mut end = loop {
            let joint = &model.joints[at];
            let leader = joint.mimic.as_ref().filter(|_| mimic_follows);
            match (resolved[at], leader) {
                _ if joint.kind == JointKind::Fixed => break Follow::Constant(0.0),
                (Some(known), _) => break known.carried_by(at),
                (None, None) => {
                    resolved[at] = Some(Follow::Nothing);
                    break Follow::Nothing.carried_by(at);
                }
                (None, Some((leader, multiplier, offset))) => {
                    let names = || (joint.name.clone(), leader.clone());
                    let Some(&next) = by_name.get(leader.as_str()) else {
                        let (joint, leader) = names();
                        return Err(PartError::NoSuchLeader { joint, leader });
                    };
                    let next_kind = model.joints[next].kind;
                    if !scalar(joint.kind) || !(scalar(next_kind) || next_kind == JointKind::Fixed) {
                        let (joint, leader) = names();
                        return Err(PartError::NotCoupled { joint, leader });
                    }
                    chain.push((at, *multiplier, *offset));
                    walked_in[at] = index;
                    if walked_in[next] == index {
                        let (joint, leader) = names();
                        return Err(PartError::MimicsItself { joint, leader });
                    }
                    at = next;
                }
            }
        };
        for (joint, multiplier, offset) in chain.into_iter().rev() {
            end = match end {
                Follow::Joint { leader, multiplier: m, offset: o } => {
                    Follow::Joint { leader, multiplier: multiplier * m, offset: multiplier * o + offset }
                }
                Follow::Constant(value) => Follow::Constant(multiplier * value + offset),
                Follow::Nothing => Follow::Nothing,
            };
            resolved[joint] = Some(end);
        }
    }
    Ok(resolved.into_iter().map(|r| r.unwrap_or(Follow::Nothing)).collect())
}

impl Follow {
    /// What a follower of the joint `index` follows, where this is what that joint itself follows.
    fn carried_by(self, index: usize) -> Self {
        match self {
            Self::Nothing => Self::Joint { leader: index, multiplier: 1.0, offset: 0.0 },
            other => other,
        }
    }
}

/// The motion of a described joint of one coordinate at a value.
pub(crate) fn moved(joint: &JointModel, value: f64) -> Pose {
    match joint.kind {
        JointKind::Revolute | JointKind::Continuous => Pose::from_rotation(DQuat::from_axis_angle(joint.axis, value)),
        JointKind::Prismatic => Pose::from_translation(joint.axis * value),
        JointKind::Planar | JointKind::Floating | JointKind::Fixed => Pose::identity(),
    }
}
