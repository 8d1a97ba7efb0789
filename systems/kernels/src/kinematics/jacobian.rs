//! How fast frames move: geometric Jacobians along the attachment tree.
//!
//! What moves a held box is the arm, not the box's own free-flyer. Velocities are those of the configuration space: a
//! free-flyer translates in its joint frame and turns in the moving frame, a follower adds `multiplier` times its column
//! to its leader's coordinate.

use crate::kinematics::attachment_tree::AttachmentTree;
use crate::kinematics::joint_table::JointCoordinates;
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, JointType};
use glam::DVec3;

impl AttachmentTree {
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
        let joint = self.joint(index);
        let JointCoordinates { v, multiplier, .. } = joint.coordinates;
        let scale = sign * multiplier;
        // A slide's axis is fixed in the body on which the joint sits.
        let slide = |axis: DVec3| (Some(joint.parent), joint.X_PJ.rotation * axis * scale);
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
