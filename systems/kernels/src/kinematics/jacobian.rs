//! How fast frames move: geometric Jacobians along the attachment tree.
//!
//! The *attachment tree* is the robot's tree with every carried object attached to its carrier instead of the world: what
//! moves a held box is the arm, not the box's own free-flyer. Velocities are those of the configuration space: a
//! free-flyer translates in its joint frame and turns in the moving frame, a follower adds `multiplier` times its column
//! to its leader's coordinate.
//!
//! A robot that flies freely may *stand*: the world is then attached to a foot of it, and what moves anything against the world
//! are the joints between it and that foot, not the root.

use crate::kinematics::joint_table::JointCoordinates;
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, JointType, Robot};
use glam::DVec3;

/// The robot's tree with carried objects attached to their carriers.
#[derive(Clone, Debug)]
pub struct AttachmentTree<'a> {
    robot: &'a Robot,
    /// For each joint the carrier, where it is carried.
    carrier: Vec<Option<Option<JointIndex>>>,
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

impl<'a> AttachmentTree<'a> {
    /// The robot's own tree.
    #[must_use]
    pub fn new(robot: &'a Robot) -> Self {
        Self { robot, carrier: vec![None; robot.joints.len()], standing: None }
    }

    /// The robot's tree with the given objects (free-flyer roots) attached to their carriers. Objects that cannot be attached as
    /// requested (see [`Self::hang`]) stay where they were.
    #[must_use]
    pub fn with_carried(robot: &'a Robot, carried: impl IntoIterator<Item = (JointIndex, Option<JointIndex>)>) -> Self {
        let mut tree = Self::new(robot);
        for (object, carrier) in carried {
            tree.hang(object, carrier);
        }
        tree
    }

    /// Attaches an object to a carrier. Returns false, and changes nothing, where the object is carried already or would
    /// carry itself.
    ///
    /// # Panics
    /// If the robot has no such joints.
    pub fn hang(&mut self, object: JointIndex, carrier: Option<JointIndex>) -> bool {
        if self.is_carried(object) || self.standing.is_some() || self.chain(carrier).any(|joint| joint == object) {
            return false;
        }
        self.carrier[object.at()] = Some(carrier);
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
        let free = self.robot.joints[root.at()].motion == JointType::FreeFlyer;
        let stands = free && root != foot && self.standing.is_none() && !self.line(foot).any(|j| self.is_carried(j));
        if !stands {
            return None;
        }
        self.carrier[root.at()] = Some(None);
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
        self.carrier[joint.at()].is_some()
    }

    /// The body to which this one is attached.
    #[must_use]
    pub fn parent(&self, joint: JointIndex) -> Option<JointIndex> {
        self.carrier[joint.at()].unwrap_or(self.robot.joints[joint.at()].parent)
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

    /// How the velocity coordinates that `variable` numbers move frames on `b` relative to frames on `a`.
    ///
    /// `variable` gives for a velocity coordinate its column, or `None` where it is not free.
    #[must_use]
    pub fn columns(
        &self,
        a: Option<JointIndex>,
        b: Option<JointIndex>,
        variable: impl Fn(usize) -> Option<usize>,
    ) -> Vec<Column> {
        let (up, down) = self.between(a, b);
        let mut columns = Vec::new();
        for (joints, sign) in [(up, -1.0), (down, 1.0)] {
            for joint in joints.into_iter().filter(|&j| !self.is_carried(j)) {
                self.columns_of(joint, sign, &variable, &mut columns);
            }
        }
        columns
    }

    pub(super) fn columns_of(
        &self,
        index: JointIndex,
        sign: f64,
        variable: &impl Fn(usize) -> Option<usize>,
        out: &mut Vec<Column>,
    ) {
        let joint = &self.robot.joints[index.at()];
        let JointCoordinates { v, multiplier, .. } = JointCoordinates::of(self.robot, joint);
        let scale = sign * multiplier;
        // A slide's axis is fixed in the body on which the joint sits.
        let slide = |axis: DVec3| (Some(joint.parent), joint.parent_from_joint.rotation * axis * scale);
        let turn = |axis: DVec3| (None, axis * scale);
        let mut push = |offset: usize, (frame, axis): (Option<Option<JointIndex>>, DVec3)| {
            let Some(variable) = variable(v + offset) else { return };
            out.push(match frame {
                Some(frame) => Column::Slide { variable, frame, axis },
                None => Column::Turn { variable, body: index, axis },
            });
        };
        match joint.motion {
            JointType::Revolute { axis } => push(0, turn(axis)),
            JointType::Prismatic { axis } => push(0, slide(axis)),
            JointType::Planar => {
                push(0, slide(DVec3::X));
                push(1, slide(DVec3::Y));
                push(2, turn(DVec3::Z));
            }
            JointType::FreeFlyer => {
                for (k, axis) in DVec3::AXES.into_iter().enumerate() {
                    push(k, slide(axis));
                    push(k + 3, turn(axis));
                }
            }
        }
    }
}

/// What one velocity coordinate does to the frames beyond one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Column {
    /// Turns them about an axis through a body's origin.
    Turn {
        /// Column of the coordinate.
        variable: usize,
        /// The body; its own motion leaves the axis in place.
        body: JointIndex,
        /// Axis in that body's frame, times multiplier and sign.
        axis: DVec3,
    },
    /// Moves them along an axis.
    Slide {
        /// Column of the coordinate.
        variable: usize,
        /// The body in which the axis is fixed; `None` for the world.
        frame: Option<JointIndex>,
        /// Axis in that body's frame, or in the world, times multiplier and sign.
        axis: DVec3,
    },
}

impl Column {
    /// Column of the coordinate.
    #[inline]
    #[must_use]
    pub fn variable(&self) -> usize {
        match *self {
            Self::Turn { variable, .. } | Self::Slide { variable, .. } => variable,
        }
    }

    pub(crate) fn variable_mut(&mut self) -> &mut usize {
        match self {
            Self::Turn { variable, .. } | Self::Slide { variable, .. } => variable,
        }
    }

    /// The velocity at unit speed of a point (given in the world) that moves with the frames, and their angular velocity;
    /// both in the world.
    ///
    /// # Panics
    /// If `X_WJ` is too short.
    #[inline]
    #[must_use]
    pub fn twist(&self, X_WJ: &[Pose], point: DVec3) -> (DVec3, DVec3) {
        match *self {
            Self::Turn { body, axis, .. } => {
                let X_WB = &X_WJ[body.at()];
                let turn = X_WB.rotation * axis;
                (turn.cross(point - X_WB.translation), turn)
            }
            Self::Slide { frame: Some(body), axis, .. } => (X_WJ[body.at()].rotation * axis, DVec3::ZERO),
            Self::Slide { frame: None, axis, .. } => (axis, DVec3::ZERO),
        }
    }
}

/// The geometric Jacobian, six numbers per column: velocity of `point` (given in the world, moving with the frames that
/// the columns move), then angular velocity, both in the world.
///
/// # Panics
/// If a slice is too short.
pub fn geometric_jacobian(columns: &[Column], X_WJ: &[Pose], point: DVec3, out: &mut [f64]) {
    out.fill(0.0);
    for column in columns {
        let (linear, angular) = column.twist(X_WJ, point);
        let numbers = &mut out[6 * column.variable()..][..6];
        for k in 0..3 {
            numbers[k] += linear[k];
            numbers[k + 3] += angular[k];
        }
    }
}
