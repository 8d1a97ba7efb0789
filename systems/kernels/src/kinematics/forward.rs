//! Forward kinematics of the hybrid robot, with objects that follow what carries them.

use crate::kinematics::joint_table::{JointEntry, joint_table};
use foliate_components::Pose;
use foliate_components::robot::configuration::quaternion;
use foliate_components::robot::{JointIndex, JointType, Robot};
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

/// The tables of forward kinematics, compiled once per robot.
#[derive(Clone, Debug)]
pub struct Kinematics {
    joints: Vec<JointEntry>,
    size: usize,
}

impl Kinematics {
    /// Compiles the tables.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        Self { joints: joint_table(robot), size: robot.space.size() }
    }

    /// Number of bodies: the length of the slices that [`Self::forward`] fills.
    #[must_use]
    pub fn bodies(&self) -> usize {
        self.joints.len()
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
        for (index, joint) in self.joints.iter().enumerate() {
            let X_PB = joint.in_parent(q);
            X_WJ[index] = match joint.parent {
                Some(parent) => X_WJ[parent.at()] * X_PB,
                None => X_PB,
            };
        }
    }

    /// As [`Self::forward`], into memory of its own: for what is not done again and again.
    ///
    /// # Panics
    /// If `q` is too short.
    #[must_use]
    pub fn poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut X_WJ = vec![Pose::identity(); self.bodies()];
        self.forward(q, &mut X_WJ);
        X_WJ
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
            for index in object + 1..self.joints.len() {
                let joint = &self.joints[index];
                let Some(parent) = joint.parent.filter(|p| p.at() >= object) else { break };
                X_WJ[index] = X_WJ[parent.at()] * joint.in_parent(q);
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
            while let Some(parent) = self.joints[body.at()].parent {
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
            let joint = &self.joints[rigid_attachment.object.at()];
            let first = joint.coordinates.q;
            // Object roots are attached to the world: their coordinates are their pose in the frame of the root joint.
            let X_JB = joint.X_PJ.inverse() * X_WJ[rigid_attachment.object.at()];
            let old = quaternion(q, first);
            let turn = X_JB.rotation.normalize();
            let turn = if turn.dot(old) < 0.0 { -turn } else { turn };
            let t = X_JB.translation;
            q[first..first + 7].copy_from_slice(&[t.x, t.y, t.z, turn.x, turn.y, turn.z, turn.w]);
        }
    }
}

impl JointEntry {
    /// Pose of the body in its parent.
    #[inline]
    fn in_parent(&self, q: &[f64]) -> Pose {
        let i = self.coordinates.q;
        let X_JB = match self.motion {
            JointType::Revolute { axis } => {
                Pose::from_rotation(DQuat::from_axis_angle(axis, self.coordinates.value(q)))
            }
            JointType::Prismatic { axis } => Pose::from_translation(axis * self.coordinates.value(q)),
            JointType::Planar => Pose::from_parts(DVec3::new(q[i], q[i + 1], 0.0), DQuat::from_rotation_z(q[i + 2])),
            JointType::FreeFlyer => Pose::from_parts(DVec3::new(q[i], q[i + 1], q[i + 2]), quaternion(q, i)),
        };
        self.X_PJ * X_JB
    }
}
