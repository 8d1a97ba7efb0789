//! Joins models into one tree and numbers their coordinates.
//!
//! Order is pinocchio's, so that configurations read alike in both: depth first, the children of a link in alphabetical
//! order of their joints' names, parts in the order in which they are given.

use crate::pose::Pose;
use crate::robot::configuration::ConfigurationSpace;
use crate::robot::error::{ComposeError, PartError};
use crate::robot::hybrid_robot::{DisabledPair, Gripper, Handle, Link, Part, Robot, Shape, Surface};
use crate::robot::indices::{JointIndex, LinkIndex, PartIndex};
use crate::robot::joint::{Joint, JointType, PartPlacement, RootJoint, Source};
use crate::robot::model::part_model::{JointKind, Model};
use crate::robot::model::tree::{Follow, Tree, follows, moved};
use glam::{DQuat, DVec3};
use std::collections::HashMap;

impl Robot {
    /// Joins the models into one tree.
    ///
    /// # Errors
    /// Duplicate part, link or joint names; a model that is not a tree; a document on an unknown link; a mimic joint whose
    /// leader is missing, follows itself, or has more than one coordinate; a leader that has no value at which all its
    /// followers keep their own limits.
    pub fn compose(parts: &[(&Model, PartPlacement)]) -> Result<Self, ComposeError> {
        let mut robot = Self::default();
        for (model, placement) in parts {
            if robot.parts.iter().any(|p| p.name == placement.name) {
                return Err(ComposeError::DuplicatePart(placement.name.clone()));
            }
            robot
                .add_part(model, placement)
                .map_err(|source| ComposeError::InPart { part: placement.name.clone(), source })?;
            let part = PartIndex(robot.parts.len() as u32 - 1);
            robot.narrow_leaders(part).map_err(|room| ComposeError::NoRoom { part: placement.name.clone(), room })?;
        }
        robot.space = ConfigurationSpace::of_joints(&robot.joints);
        Ok(robot)
    }

    // Long: tables are filled in one order, and each loop uses the ids that the loop before it gave.
    fn add_part(&mut self, model: &Model, placement: &PartPlacement) -> Result<(), PartError> {
        let tree = Tree::of(model)?;
        let follows = follows(model, placement.mimic_follows)?;
        let part = PartIndex(self.parts.len() as u32);
        let (first_joint, first_link) = (self.joints.len(), self.links.len());
        let prefixed = |name: &str| format!("{}/{name}", placement.name);
        let (mut q, mut v) = self.next_coordinates();

        let root_joint = match placement.root {
            RootJoint::Fixed => None,
            RootJoint::FreeFlyer => Some(JointType::FreeFlyer),
            RootJoint::Planar => Some(JointType::Planar),
        }
        .map(|motion| {
            let mut lower = vec![f64::NEG_INFINITY; motion.configuration_size()];
            let mut upper = vec![f64::INFINITY; motion.configuration_size()];
            for (i, &(low, high)) in placement.root_bounds.iter().enumerate().take(lower.len()) {
                (lower[i], upper[i]) = (low, high);
            }
            self.joints.push(Joint {
                name: prefixed("root_joint"),
                part,
                parent: None,
                parent_from_joint: placement.world_from_root,
                motion,
                source: Source::Coordinates { q, v },
                lower,
                upper,
                velocity_limit: None,
            });
            q += motion.configuration_size();
            v += motion.velocity_size();
            JointIndex(first_joint as u32)
        });

        let root_pose = if root_joint.is_some() { Pose::identity() } else { placement.world_from_root };
        let mut walk = Walk {
            robot: self,
            model,
            tree: &tree,
            placement,
            part,
            follows: &follows,
            link_index: vec![LinkIndex(0); model.links.len()],
            joint_index: vec![None; model.joints.len()],
            q,
            v,
        };
        walk.visit_all(root_joint, root_pose);
        let (link_index, joint_index) = (walk.link_index, walk.joint_index);
        for (index, follow) in follows.iter().enumerate() {
            if let Follow::Joint { leader, multiplier, offset } = *follow
                && let (Some(joint), Some(leader)) = (joint_index[index], joint_index[leader])
            {
                self.joints[joint.at()].source = Source::Follows { leader, multiplier, offset };
            }
        }

        self.add_documents(model, &link_index, &placement.name)?;
        self.parts.push(Part {
            name: placement.name.clone(),
            kind: placement.kind,
            root: placement.root,
            world_from_root: placement.world_from_root,
            root_link: link_index[tree.root],
            root_joint,
            joints: first_joint..self.joints.len(),
            links: first_link..self.links.len(),
            mimic_follows: placement.mimic_follows,
            has_srdf: model.has_srdf,
            group_states: model.group_states.clone(),
        });
        Ok(())
    }
}

impl Robot {
    fn next_coordinates(&self) -> (usize, usize) {
        self.joints.iter().fold((0, 0), |(q, v), joint| match joint.source {
            Source::Coordinates { .. } => (q + joint.motion.configuration_size(), v + joint.motion.velocity_size()),
            Source::Follows { .. } => (q, v),
        })
    }

    fn add_documents(&mut self, model: &Model, link_index: &[LinkIndex], part: &str) -> Result<(), PartError> {
        let by_name: HashMap<&str, LinkIndex> =
            model.links.iter().zip(link_index).map(|(l, &i)| (l.name.as_str(), i)).collect();
        let link = |what, name: &str, link: &str| {
            by_name.get(link).copied().ok_or_else(|| PartError::NoLinkOf { what, name: name.into(), link: link.into() })
        };
        for g in &model.grippers {
            self.grippers.push(Gripper {
                name: format!("{part}/{}", g.name),
                link: link("gripper", &g.name, &g.link)?,
                link_from_gripper: g.link_from_gripper,
                clearance: g.clearance,
            });
        }
        for h in &model.handles {
            self.handles.push(Handle {
                name: format!("{part}/{}", h.name),
                link: link("handle", &h.name, &h.link)?,
                link_from_handle: h.link_from_handle,
                clearance: h.clearance,
                mask: h.mask,
                mask_complement: h.mask_complement,
                approaching_direction: h.approaching_direction,
            });
        }
        for s in &model.surfaces {
            self.surfaces.push(Surface {
                name: format!("{part}/{}", s.name),
                link: link("contact surface", &s.name, &s.link)?,
                points: s.points.clone(),
                polygons: s.polygons.clone(),
            });
        }
        for (first, second, reason) in &model.disabled_pairs {
            // SRDFs name links of other variants of a robot; such pairs disable nothing (the reader warns about them).
            if let (Some(&first), Some(&second)) = (by_name.get(first.as_str()), by_name.get(second.as_str())) {
                self.disabled_pairs.push(DisabledPair { first, second, reason: reason.clone() });
            }
        }
        Ok(())
    }
}

/// The depth-first traversal that numbers links, shapes and joints of one part.
struct Walk<'a> {
    robot: &'a mut Robot,
    model: &'a Model,
    tree: &'a Tree,
    placement: &'a PartPlacement,
    part: PartIndex,
    follows: &'a [Follow],
    link_index: Vec<LinkIndex>,
    /// Moving joints of the model by their number in it; leaders may come later in the tree than their followers.
    joint_index: Vec<Option<JointIndex>>,
    q: usize,
    v: usize,
}

impl Walk<'_> {
    /// Visits every link with an explicit stack: files may nest deeper than the call stack.
    fn visit_all(&mut self, root_joint: Option<JointIndex>, root_pose: Pose) {
        let mut stack = vec![(None, self.tree.root, root_joint, root_pose)];
        while let Some((via, link, parent, parent_from_link)) = stack.pop() {
            let (joint, joint_from_link) = match via.filter(|&j| self.moves(j)) {
                Some(j) => self.add_joint(j, parent, parent_from_link),
                None => (parent, parent_from_link),
            };
            self.add_link(via, link, joint, joint_from_link);
            for &j in self.tree.children[link].iter().rev() {
                let child = &self.model.joints[j];
                let mut pose = joint_from_link * child.parent_from_joint;
                if let Follow::Constant(value) = self.follows[j] {
                    pose *= moved(child, value);
                }
                stack.push((Some(j), child.child, joint, pose));
            }
        }
    }

    /// Whether a joint moves its link: it is not fixed, and does not follow one that is.
    fn moves(&self, joint: usize) -> bool {
        self.model.joints[joint].kind != JointKind::Fixed && !matches!(self.follows[joint], Follow::Constant(_))
    }

    /// Numbers a moving joint; returns it and the pose of its child link in its frame.
    fn add_joint(
        &mut self,
        index: usize,
        parent: Option<JointIndex>,
        parent_from_joint: Pose,
    ) -> (Option<JointIndex>, Pose) {
        let described = &self.model.joints[index];
        let axis = described.axis;
        let (motion, joint_from_link) = match described.kind {
            JointKind::Revolute | JointKind::Continuous => (JointType::Revolute { axis }, Pose::identity()),
            JointKind::Prismatic => (JointType::Prismatic { axis }, Pose::identity()),
            // Our planar joint moves in its own xy plane: turn its frame so that z is the described normal.
            JointKind::Planar => {
                let turn = Pose::from_rotation(DQuat::from_rotation_arc(DVec3::Z, axis));
                (JointType::Planar, turn.inverse())
            }
            JointKind::Floating | JointKind::Fixed => (JointType::FreeFlyer, Pose::identity()),
        };
        let parent_from_joint = parent_from_joint * joint_from_link.inverse();
        let size = motion.configuration_size();
        let (mut lower, mut upper) = (vec![f64::NEG_INFINITY; size], vec![f64::INFINITY; size]);
        if matches!(described.kind, JointKind::Revolute | JointKind::Prismatic) {
            (lower[0], upper[0]) = described.limits;
        }
        for (i, low, high) in self.bounds_given(&described.name, motion) {
            (lower[i], upper[i]) = (low, high);
        }
        let number = self.robot.joints.len();
        self.joint_index[index] = Some(JointIndex(number as u32));
        let source = match self.follows[index] {
            // The leader is named once all joints have numbers.
            Follow::Joint { multiplier, offset, .. } => {
                Source::Follows { leader: JointIndex(number as u32), multiplier, offset }
            }
            Follow::Nothing | Follow::Constant(_) => {
                let source = Source::Coordinates { q: self.q, v: self.v };
                self.q += size;
                self.v += motion.velocity_size();
                source
            }
        };
        self.robot.joints.push(Joint {
            name: format!("{}/{}", self.placement.name, described.name),
            part: self.part,
            parent,
            parent_from_joint,
            motion,
            source,
            lower,
            upper,
            velocity_limit: described.velocity_limit,
        });
        (Some(JointIndex(number as u32)), joint_from_link)
    }

    /// The bounds that the placement gives a joint of the model: number of the coordinate, lower, upper.
    fn bounds_given(&self, joint: &str, motion: JointType) -> impl Iterator<Item = (usize, f64, f64)> {
        self.placement.joint_bounds.iter().filter_map(move |(name, low, high)| {
            let number = match name.strip_prefix(joint)? {
                "" if motion.axes().is_empty() => 0,
                rest => motion.axes().iter().position(|axis| rest.strip_prefix('/') == Some(axis))?,
            };
            Some((number, *low, *high))
        })
    }

    fn add_link(&mut self, via: Option<usize>, link: usize, joint: Option<JointIndex>, joint_from_link: Pose) {
        let described = &self.model.links[link];
        let index = LinkIndex(self.robot.links.len() as u32);
        self.link_index[link] = index;
        let name = format!("{}/{}", self.placement.name, described.name);
        for (number, (link_from_shape, geometry)) in described.shapes.iter().enumerate() {
            self.robot.shapes.push(Shape {
                name: format!("{name}_{number}"),
                link: index,
                joint_from_shape: joint_from_link * *link_from_shape,
                geometry: geometry.clone(),
            });
        }
        let parent = via.map(|joint| self.link_index[self.model.joints[joint].parent]);
        let (part, inertial) = (self.part, described.inertial);
        self.robot.links.push(Link { name, part, joint, joint_from_link, parent, inertial });
    }
}

#[cfg(test)]
mod tests {
    use crate::pose::Pose;

    use crate::robot::hybrid_robot::Robot;
    use crate::robot::indices::JointIndex;
    use crate::robot::joint::{PartKind, PartPlacement, RootJoint, Source};

    use crate::robot::model::part_model::{JointKind, JointModel, LinkModel, Model};
    use glam::DVec3;

    /// A chain of links by joints of the given kinds; joint i is called by its number.
    fn chain(kinds: &[JointKind]) -> Model {
        let link = |i: usize| LinkModel { name: format!("link{i}"), ..LinkModel::default() };
        let joint = |(i, &kind): (usize, &JointKind)| JointModel {
            name: i.to_string(),
            kind,
            parent: i,
            child: i + 1,
            parent_from_joint: Pose::identity(),
            axis: DVec3::Z,
            limits: (-1.0, 1.0),
            velocity_limit: None,
            mimic: None,
        };
        Model {
            links: (0..=kinds.len()).map(link).collect(),
            joints: kinds.iter().enumerate().map(joint).collect(),
            ..Model::default()
        }
    }

    fn placement() -> PartPlacement {
        PartPlacement::new("part", PartKind::Robot, RootJoint::Fixed, Pose::identity())
    }

    #[test]
    fn a_follower_of_a_follower_follows_the_joint_that_has_a_coordinate() {
        let mut model = chain(&[JointKind::Revolute; 3]);
        model.joints[0].mimic = Some(("2".into(), 2.0, 0.5));
        model.joints[2].mimic = Some(("1".into(), -3.0, 0.25));
        let robot = Robot::compose(&[(&model, placement())]).expect("composes");
        let follows = Source::Follows { leader: JointIndex(1), multiplier: -6.0, offset: 1.0 };
        assert_eq!(robot.joints[0].source, follows);
        assert_eq!(robot.space.size(), 1);
    }

    #[test]
    fn joints_that_follow_each_other_are_refused() {
        let mut model = chain(&[JointKind::Revolute; 2]);
        model.joints[0].mimic = Some(("1".into(), 1.0, 0.0));
        model.joints[1].mimic = Some(("0".into(), 1.0, 0.0));
        let error = Robot::compose(&[(&model, placement())]).expect_err("a cycle");
        assert!(error.to_string().contains("mimics itself"), "{error}");
    }

    #[test]
    fn a_follower_of_a_fixed_joint_stands_still_at_its_offset() {
        let mut model = chain(&[JointKind::Fixed, JointKind::Prismatic]);
        model.joints[1].mimic = Some(("0".into(), 1.0, 0.5));
        let robot = Robot::compose(&[(&model, placement())]).expect("composes");
        assert!(robot.joints.is_empty());
        assert_eq!(robot.links[2].joint_from_link.translation, DVec3::new(0.0, 0.0, 0.5));
    }
}
