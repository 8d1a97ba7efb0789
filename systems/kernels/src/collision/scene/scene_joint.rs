//! A joint as the motion bounds need it: its mounting, its motion, its coordinates and whether it is locked.
//!
//! `CollisionScene` keeps one entry per joint. Followers are resolved to the coordinates of their leader, so that the attachment
//! tree, the placement of bodies and the motion bounds do not need the `Robot`.

use foliate_components::robot::{JointIndex, JointType, Robot, Source};
use glam::{DQuat, DVec3};

/// What bounds on motions need to know of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SceneJoint {
    pub parent: Option<JointIndex>,
    /// Position of the joint frame at zero in the parent's frame.
    pub offset: DVec3,
    /// Orientation of the joint frame at zero in the parent's frame.
    pub turned: DQuat,
    pub motion: JointType,
    pub locked: bool,
    /// First coordinates (own, or of the leader) in a configuration and a velocity.
    pub q: usize,
    pub v: usize,
    pub multiplier: f64,
    /// Offset of a follower, radians or metres.
    pub constant: f64,
}

impl SceneJoint {
    pub(crate) fn new(robot: &Robot, index: usize, locked: &[JointIndex]) -> Self {
        let joint = &robot.joints[index];
        let is_locked = |j: JointIndex| locked.contains(&j);
        let own = is_locked(JointIndex(index as u32));
        let (q, v, multiplier, constant, locked) = match joint.source {
            Source::Coordinates { q, v } => (q, v, 1.0, 0.0, own),
            Source::Follows { leader, multiplier, offset } => {
                let locked = own || is_locked(leader);
                match robot.joints[leader.at()].source {
                    Source::Coordinates { q, v } => (q, v, multiplier, offset, locked),
                    // `Robot::compose` resolves chains; a follower of a follower cannot arise, and would not move.
                    Source::Follows { .. } => (0, 0, 0.0, offset, true),
                }
            }
        };
        Self {
            parent: joint.parent,
            offset: joint.parent_from_joint.translation,
            turned: joint.parent_from_joint.rotation,
            motion: joint.motion,
            locked,
            q,
            v,
            multiplier,
            constant,
        }
    }
}
