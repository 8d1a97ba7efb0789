//! Forward kinematics of the hybrid robot, with objects that follow what carries them.

use foliate_components::Pose;
use foliate_components::robot::configuration::quaternion;
use foliate_components::robot::{JointIndex, JointType, Robot, Source};
use glam::{DQuat, DVec3};

/// An object that follows a carrier rigidly: an eliminated variable (HPP's explicit relative pose).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidAttachment {
    /// Free-flyer root joint of the object.
    pub object: JointIndex,
    /// Body that carries it; `None` where that is the world.
    pub carrier: Option<JointIndex>,
    /// Pose of the object's root joint frame in the carrier's joint frame, or in the world.
    pub X_CO: Pose,
}

/// A frame on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The body; `None` where the frame is fixed in the world.
    pub joint: Option<JointIndex>,
    /// Pose of the frame in that body's joint frame, or in the world.
    pub X_JF: Pose,
}

impl Placement {
    /// Pose of the frame in the world.
    #[must_use]
    pub fn in_world(&self, X_WJ: &[Pose]) -> Pose {
        match self.joint {
            Some(joint) => X_WJ[joint.at()] * self.X_JF,
            None => self.X_JF,
        }
    }
}

/// One joint, as the loop over them wants it.
#[derive(Clone, Copy, Debug)]
struct Step {
    parent: Option<JointIndex>,
    X_PJ: Pose,
    motion: JointType,
    /// First coordinate of the joint itself, or of the joint that it follows.
    q: usize,
    multiplier: f64,
    offset: f64,
}

/// The tables of forward kinematics, compiled once per robot.
#[derive(Clone, Debug)]
pub struct Kinematics {
    steps: Vec<Step>,
    /// Joints in an order in which every leader and parent comes first; the robot's own order has parents first.
    size: usize,
}

impl Kinematics {
    /// Compiles the tables.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let steps = robot
            .joints
            .iter()
            .map(|joint| {
                let (q, multiplier, offset) = match joint.source {
                    Source::Coordinates { q, .. } => (q, 1.0, 0.0),
                    Source::Follows { leader, multiplier, offset } => match robot.joints[leader.at()].source {
                        Source::Coordinates { q, .. } => (q, multiplier, offset),
                        // `Robot::compose` resolves chains; a follower of a follower cannot arise.
                        Source::Follows { .. } => (0, 0.0, offset),
                    },
                };
                Step {
                    parent: joint.parent,
                    X_PJ: joint.parent_from_joint,
                    motion: joint.motion,
                    q,
                    multiplier,
                    offset,
                }
            })
            .collect();
        Self { steps, size: robot.space.size() }
    }

    /// Number of bodies: the length of the slices that [`Self::forward`] fills.
    #[must_use]
    pub fn bodies(&self) -> usize {
        self.steps.len()
    }

    /// Length of a configuration.
    #[must_use]
    pub fn configuration_size(&self) -> usize {
        self.size
    }

    /// Poses of all bodies (joint frames after their motion) in the world, at configuration `q`.
    ///
    /// # Panics
    /// If `q` or `X_WJ` is too short.
    pub fn forward(&self, q: &[f64], X_WJ: &mut [Pose]) {
        for (index, step) in self.steps.iter().enumerate() {
            let X_JB = step.moved(q);
            let X_PB = step.X_PJ * X_JB;
            X_WJ[index] = match step.parent {
                Some(parent) => X_WJ[parent.at()] * X_PB,
                None => X_PB,
            };
        }
    }

    /// Moves carried objects to where their carriers take them, in any order of `rigid_attachments`. Bodies that are attached to an
    /// object's root by joints of their own follow. Objects that carry each other in a circle end anywhere.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn carry(&self, q: &[f64], rigid_attachments: &[RigidAttachment], X_WJ: &mut [Pose]) {
        for rigid_attachment in std::iter::repeat_n(rigid_attachments, self.passes(rigid_attachments)).flatten() {
            let object = rigid_attachment.object.at();
            X_WJ[object] = match rigid_attachment.carrier {
                Some(carrier) => X_WJ[carrier.at()] * rigid_attachment.X_CO,
                None => rigid_attachment.X_CO,
            };
            // An articulated object's own joints stand directly behind its root.
            for index in object + 1..self.steps.len() {
                let step = &self.steps[index];
                let Some(parent) = step.parent.filter(|p| p.at() >= object) else { break };
                X_WJ[index] = X_WJ[parent.at()] * (step.X_PJ * step.moved(q));
            }
        }
    }

    /// How often to go through rigid attachments: in dependency order, which is the rule, once is enough; otherwise each pass
    /// settles at least one more.
    pub(crate) fn passes(&self, rigid_attachments: &[RigidAttachment]) -> usize {
        if self.carriers_come_first(rigid_attachments) { 1 } else { rigid_attachments.len() }
    }

    /// Whether no carrier is part of an object that is carried later.
    fn carriers_come_first(&self, rigid_attachments: &[RigidAttachment]) -> bool {
        let root = |body: JointIndex| {
            let mut body = body;
            while let Some(parent) = self.steps[body.at()].parent {
                body = parent;
            }
            body
        };
        let late = |(index, rigid_attachment): (usize, &RigidAttachment)| {
            let Some(carrier) = rigid_attachment.carrier.map(root) else { return false };
            rigid_attachments[index + 1..].iter().any(|later| later.object == carrier)
        };
        !rigid_attachments.iter().enumerate().any(late)
    }

    /// Writes the poses of carried objects back into a configuration.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn write_back(&self, rigid_attachments: &[RigidAttachment], X_WJ: &[Pose], q: &mut [f64]) {
        for rigid_attachment in rigid_attachments {
            let step = &self.steps[rigid_attachment.object.at()];
            // Object roots are attached to the world: their coordinates are their pose in the frame of the root joint.
            let X_JB = step.X_PJ.inverse() * X_WJ[rigid_attachment.object.at()];
            let old = quaternion(q, step.q);
            let turn = X_JB.rotation.normalize();
            let turn = if turn.dot(old) < 0.0 { -turn } else { turn };
            let t = X_JB.translation;
            q[step.q..step.q + 7].copy_from_slice(&[t.x, t.y, t.z, turn.x, turn.y, turn.z, turn.w]);
        }
    }
}

impl Step {
    /// Pose of the body in the joint frame at zero.
    #[inline]
    fn moved(&self, q: &[f64]) -> Pose {
        let value = |i: usize| self.multiplier * q[self.q + i] + self.offset;
        match self.motion {
            JointType::Revolute { axis } => Pose::from_rotation(DQuat::from_axis_angle(axis, value(0))),
            JointType::Prismatic { axis } => Pose::from_translation(axis * value(0)),
            JointType::Planar => {
                Pose::from_parts(DVec3::new(q[self.q], q[self.q + 1], 0.0), DQuat::from_rotation_z(q[self.q + 2]))
            }
            JointType::FreeFlyer => {
                Pose::from_parts(DVec3::new(q[self.q], q[self.q + 1], q[self.q + 2]), quaternion(q, self.q))
            }
        }
    }
}
