//! A gripper holds a handle (P0 §II-C.2, eq. 6–9).
//!
//! The rows are those of the handle frame in the gripper frame. The handle's mask says which are zero in a grasp, its mask
//! complement which are frozen along a motion while held. A solid grasp has all six; an axial one leaves the turn about
//! the common z axis to the complement; HPP's masks allow anything else but exactly one rotation.

use super::row::{Rows, rows};
use super::{Constraint, Frame, Mask, MaskError, Reference, Region, RelativePose, Tilt};
use crate::Pose;
use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{GripperIndex, HandleIndex};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Which gripper holds which handle, with the frames of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grasp {
    /// The gripper's frame on its body.
    pub gripper: Frame,
    /// The handle's frame on its body.
    pub handle: Frame,
    /// Rows that are zero.
    pub mask: Mask,
    /// Rows that are frozen while held.
    pub complement: Mask,
    /// How far a pre-grasp stands back, metres: the sum of both clearances.
    pub standoff: f64,
}

/// What is bounded while a gripper goes to a handle along a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ApproachBound {
    /// How far its origin is from the x axis of the handle.
    Line,
    /// The angle between the x axes of both.
    Aim,
    /// The angle between the z axes of both.
    Roll,
}

impl Grasp {
    /// Reads both documents.
    ///
    /// # Errors
    /// A handle whose mask constrains exactly one rotation.
    ///
    /// # Panics
    /// If the robot has no such gripper or handle.
    pub fn new(robot: &Robot, gripper: GripperIndex, handle: HandleIndex) -> Result<Self, MaskError> {
        let (g, h) = (&robot.grippers[gripper.at()], &robot.handles[handle.at()]);
        Ok(Self {
            gripper: Frame::on_link(robot, g.link, &g.link_from_gripper),
            handle: Frame::on_link(robot, h.link, &h.link_from_handle),
            mask: Mask(h.mask).of_grasp()?,
            complement: Mask(h.mask_complement),
            standoff: g.clearance + h.clearance,
        })
    }

    /// G_f = 0: the rows of the mask are zero.
    #[must_use]
    pub fn constraint(&self) -> RelativePose {
        self.with(rows(self.mask, Mask::NONE), Reference::Identity)
    }

    /// Ḡ_f: the rows of the complement equal the leaf parameter in `slot`.
    #[must_use]
    pub fn complement(&self, slot: usize) -> RelativePose {
        self.with(rows(Mask::NONE, self.complement), Reference::Argument(slot))
    }

    /// G_f = 0 and Ḡ_f equal to the leaf parameter in `slot`: a motion with the object in hand.
    #[must_use]
    pub fn hold(&self, slot: usize) -> RelativePose {
        let rows = rows(self.mask, self.complement);
        let has_parameter = rows.contains(&Some(super::Row::Parameter));
        self.with(rows, if has_parameter { Reference::Argument(slot) } else { Reference::Identity })
    }

    /// The grasp with the gripper standing back by the sum of the clearances.
    #[must_use]
    pub fn pregrasp(&self) -> RelativePose {
        self.pregrasp_at(self.standoff)
    }

    /// The grasp with the gripper standing back by `distance` metres: the frame `distance` ahead of the gripper along its
    /// own x takes the handle's place.
    #[must_use]
    pub fn pregrasp_at(&self, distance: f64) -> RelativePose {
        let ahead = Pose::from_translation(DVec3::X * distance);
        RelativePose { a: self.gripper.then(&ahead), ..self.constraint() }
    }

    /// Whether the pregrasps of this grasp lie on one line, the x axis of the handle: all rows count, but for the rotation about it.
    #[must_use]
    pub fn has_line(&self) -> bool {
        let [tx, ty, tz, _, ry, rz] = self.mask.0;
        tx && ty && tz && ry && rz && self.standoff > 0.0
    }

    /// What bounds the way from the pregrasp to the grasp: within `distance` metres of the line along y and z, and turned by no more
    /// than `angle` radians. None for a rotation about the line that the grasp leaves free.
    #[must_use]
    pub fn approach(&self, bound: ApproachBound, distance: f64, angle: f64) -> Option<Constraint> {
        let (a, b) = (self.handle, self.gripper);
        let tilt = |about: Pose| Constraint::Tilt(Tilt { a: a.then(&about), b: b.then(&about), within: angle });
        match bound {
            ApproachBound::Line => {
                let bounds = [(f64::NEG_INFINITY, f64::INFINITY), (-distance, distance), (-distance, distance)];
                Some(Constraint::Region(Region { a, b, bounds }))
            }
            // Turned so that z is the x axis.
            ApproachBound::Aim => Some(tilt(Pose::from_rotation(DQuat::from_rotation_y(FRAC_PI_2)))),
            ApproachBound::Roll => self.mask.0[3].then(|| tilt(Pose::identity())),
        }
    }

    fn with(&self, rows: Rows, reference: Reference) -> RelativePose {
        RelativePose { a: self.gripper, b: self.handle, rows, reference }
    }
}
