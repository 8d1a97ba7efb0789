//! The *attachment tree*: the robot's tree with every carried object attached to its carrier instead of the world.
//!
//! A robot that flies freely may *stand*: the world is then attached to a foot of it, and what moves anything against the world
//! are the joints between it and that foot, not the root.

use crate::kinematics::joint_table::{JointEntry, joint_table};
use foliate_components::robot::{JointIndex, JointType, Robot};
use std::sync::Arc;

/// The robot's tree with carried objects attached to their carriers.
#[derive(Clone, Debug)]
pub struct AttachmentTree {
    joints: Arc<[JointEntry]>,
    /// By body: what it is attached to, its carrier where it is carried; `None` for the world.
    parents: Vec<Option<JointIndex>>,
    /// By body: whether it is the root of a carried object, or of a robot that stands.
    carried: Vec<bool>,
    standing: Option<Standing>,
}

/// A robot whose root follows where a foot of it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Standing {
    /// Its free-flyer.
    pub root: JointIndex,
    /// The body that stands in the world.
    pub foot: JointIndex,
}

impl AttachmentTree {
    /// The robot's own tree.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        Self::of_table(joint_table(robot).into())
    }

    /// The tree of these joints, with nothing carried.
    pub(crate) fn of_table(joints: Arc<[JointEntry]>) -> Self {
        let parents = joints.iter().map(|joint| joint.parent).collect();
        Self { carried: vec![false; joints.len()], parents, joints, standing: None }
    }

    /// The robot's tree with the given objects (free-flyer roots) attached to their carriers. Objects that cannot be attached as
    /// asked (see [`Self::attach`]) stay where they were.
    #[must_use]
    pub fn with_carried(robot: &Robot, carried: impl IntoIterator<Item = (JointIndex, Option<JointIndex>)>) -> Self {
        let mut tree = Self::new(robot);
        for (object, carrier) in carried {
            tree.attach(object, carrier);
        }
        tree
    }

    /// Attaches an object to a carrier. Returns false, and changes nothing, where the object is carried already or would
    /// carry itself.
    ///
    /// # Panics
    /// If the robot has no such joints.
    pub fn attach(&mut self, object: JointIndex, carrier: Option<JointIndex>) -> bool {
        if self.is_carried(object) || self.standing.is_some() || self.chain(carrier).any(|joint| joint == object) {
            return false;
        }
        self.parents[object.at()] = carrier;
        self.carried[object.at()] = true;
        true
    }

    /// Attaches the world to a body of a robot that flies freely; its root is then carried. Comes after all objects have been
    /// attached. Returns the robot's root, or `None`, and changes nothing, where a robot stands already, or the body is no
    /// foot: a root itself, or on nothing that flies freely.
    ///
    /// # Panics
    /// If the robot has no such joint.
    pub fn stand_on(&mut self, foot: JointIndex) -> Option<JointIndex> {
        let root = self.line(foot).last()?;
        let free = self.joint(root).motion == JointType::FreeFlyer;
        let stands = free && root != foot && self.standing.is_none() && !self.line(foot).any(|j| self.is_carried(j));
        if !stands {
            return None;
        }
        self.parents[root.at()] = None;
        self.carried[root.at()] = true;
        self.standing = Some(Standing { root, foot });
        Some(root)
    }

    /// The robot that stands, where one does.
    #[must_use]
    pub fn standing(&self) -> Option<Standing> {
        self.standing
    }

    /// Whether the joint is an eliminated object's root, or that of a robot that stands.
    #[must_use]
    pub fn is_carried(&self, joint: JointIndex) -> bool {
        self.carried[joint.at()]
    }

    /// The body to which this one is attached.
    #[must_use]
    pub fn parent(&self, joint: JointIndex) -> Option<JointIndex> {
        self.parents[joint.at()]
    }

    /// The joint that moves a body where it is not carried.
    pub(crate) fn joint(&self, body: JointIndex) -> &JointEntry {
        &self.joints[body.at()]
    }

    /// The body and those to which it is attached, outermost first, up to the world.
    pub fn line(&self, joint: JointIndex) -> impl Iterator<Item = JointIndex> + '_ {
        std::iter::successors(Some(joint), |&j| self.parent(j))
    }

    /// The body (or the world) and those to which it is attached, outermost first. Where a robot stands, the world is attached to its
    /// foot, and its root is what all else is attached to.
    pub fn chain(&self, joint: Option<JointIndex>) -> impl Iterator<Item = JointIndex> + '_ {
        let below_world = self.standing.map(|standing| standing.foot);
        let is_last = move |joint| self.standing.is_some_and(|standing| standing.root == joint);
        std::iter::successors(joint.or(below_world), move |&j| {
            self.parent(j).or_else(|| below_world.filter(|_| !is_last(j)))
        })
    }

    /// The bodies between two: those above `a` (outermost first) and those above `b` (innermost first), without the
    /// bodies that both are attached to, for these move neither relative to the other.
    #[must_use]
    pub fn between(&self, a: Option<JointIndex>, b: Option<JointIndex>) -> (Vec<JointIndex>, Vec<JointIndex>) {
        let (mut up, mut down): (Vec<_>, Vec<_>) = (self.chain(a).collect(), self.chain(b).collect());
        while let (Some(x), Some(y)) = (up.last(), down.last())
            && x == y
        {
            up.pop();
            down.pop();
        }
        down.reverse();
        (up, down)
    }
}
