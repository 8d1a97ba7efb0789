//! Two frames in a given relative pose, wholly or in some components (P0 §II-B, §II-C.2).

use super::row::{Row, Rows};
use crate::Pose;
use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{JointIndex, LinkIndex};

/// A frame on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The body, named by the joint that moves it; `None` where the frame is fixed in the world.
    pub joint: Option<JointIndex>,
    /// Pose of the frame in that body's joint frame, or in the world.
    pub joint_from_frame: Pose,
}

impl Frame {
    /// A frame fixed in the world.
    #[must_use]
    pub fn world(pose: Pose) -> Self {
        Self { joint: None, joint_from_frame: pose }
    }

    /// The joint frame of a body itself.
    #[must_use]
    pub fn of_joint(joint: JointIndex) -> Self {
        Self { joint: Some(joint), joint_from_frame: Pose::identity() }
    }

    /// A frame given in a link.
    ///
    /// # Panics
    /// If the robot has no such link.
    #[must_use]
    pub fn on_link(robot: &Robot, link: LinkIndex, link_from_frame: &Pose) -> Self {
        let (joint, joint_from_frame) = robot.frame_on_joint(link, link_from_frame);
        Self { joint, joint_from_frame }
    }

    /// This frame moved within itself.
    #[must_use]
    pub fn then(self, motion: &Pose) -> Self {
        Self { joint: self.joint, joint_from_frame: self.joint_from_frame * *motion }
    }
}

/// Where the reference of a relative pose comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// The frames coincide.
    Identity,
    /// A pose of B in A that never changes.
    Fixed(Pose),
    /// A pose of B in A that is an argument of the solve: the leaf parameter in that slot.
    Argument(usize),
}

/// Frame B in frame A, compared with a reference X_ref.
///
/// The value has the six rows `[R_Aᵀ(p_B − p_A) − t_ref; log(R_refᵀ R_Aᵀ R_B)]` (metres, radians): the translation in the
/// axes of A, so that a mask means the same for every reference, and the rotation vector of what is left to turn. This is
/// the logarithm of R³ × SO(3), not of SE(3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativePose {
    /// Frame A, in whose axes the rows are read.
    pub a: Frame,
    /// Frame B.
    pub b: Frame,
    /// What each of tx ty tz rx ry rz asks for.
    pub rows: Rows,
    /// The reference pose of B in A.
    pub reference: Reference,
}

impl RelativePose {
    /// All six rows zero at the reference.
    #[must_use]
    pub fn rigid(a: Frame, b: Frame, reference: Reference) -> Self {
        let row = if matches!(reference, Reference::Argument(_)) { Row::Parameter } else { Row::Zero };
        Self { a, b, rows: [Some(row); 6], reference }
    }

    /// Number of rows.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.rows.iter().flatten().count()
    }

    /// Whether the pose of B in A is determined wholly, by equations.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        self.rows.iter().all(|row| matches!(row, Some(Row::Zero | Row::Parameter)))
    }
}
