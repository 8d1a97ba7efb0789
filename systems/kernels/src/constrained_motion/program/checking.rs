//! Checks of constraints before they are compiled: joints that exist, finite and positive numbers, admissible rows.
//!
//! Each check returns a `CompileError` that names the constraint. The checks read the `Compiler` and change nothing.

use crate::constrained_motion::program::elimination::Compiler;
use crate::constrained_motion::program::error::{CompileError, fit, fits_rows};
use foliate_components::constraint::{BodyMass, Constraint, Masses, PlaneRow, Row, Tilt};
use foliate_components::robot::{JointIndex, JointType};

impl Compiler<'_> {
    pub(crate) fn known(&self, constraint: usize, joint: Option<JointIndex>) -> Result<(), CompileError> {
        let joints = self.robot.joints.len();
        match joint {
            Some(joint) if joint.at() >= joints => Err(CompileError::NoSuchJoint { constraint, joint, joints }),
            _ => Ok(()),
        }
    }

    pub(crate) fn check_joints(&self, number: usize, constraint: &Constraint) -> Result<(), CompileError> {
        match constraint {
            Constraint::RelativePose(pose) => {
                self.known(number, pose.a.joint)?;
                self.known(number, pose.b.joint)
            }
            Constraint::Placement(p) | Constraint::PlacementComplement(p, _) | Constraint::PlacementHold(p, _) => {
                if p.object.is_empty() || p.supports.is_empty() {
                    return Err(CompileError::EmptyPlacement(number));
                }
                p.object.iter().chain(&p.supports).try_for_each(|polygon| self.known(number, polygon.frame.joint))
            }
            Constraint::Locked(locked) => self.known(number, Some(locked.joint)),
            Constraint::CentreOfMass(balance) => {
                self.known(number, balance.frame.joint)?;
                self.masses_known(number, &balance.masses)?;
                fit(number, fits_rows(balance.rows.len()))?;
                let straight =
                    |plane: &PlaneRow| (plane.normal.length() - 1.0).abs() < 1e-9 && plane.offset.is_finite();
                fit(number, (!balance.rows.iter().all(straight)).then_some("a normal is not a unit vector"))
            }
            Constraint::CentreOfMassBetween(balance) => {
                self.known(number, balance.first.joint)?;
                self.known(number, balance.second.joint)?;
                self.masses_known(number, &balance.masses)?;
                fit(number, balance.height.filter(|h| !h.is_finite()).map(|_| "the height is not a finite number"))
            }
            Constraint::Distance(distance) => {
                self.known(number, distance.a.joint)?;
                self.known(number, distance.b.joint)?;
                let positive = distance.length.is_finite() && distance.length > 0.0;
                fit(number, (!positive).then_some("the distance is not a positive number"))?;
                fit(number, (distance.row == Row::Parameter).then_some("a distance is no parameter"))
            }
            Constraint::Tilt(tilt) => {
                self.known(number, tilt.a.joint)?;
                self.known(number, tilt.b.joint)?;
                let is_bounded = (Tilt::LEAST..=Tilt::MOST).contains(&tilt.within);
                fit(number, (!is_bounded).then_some("the angle is not between 0.01 radians and a right angle"))
            }
            Constraint::Region(region) => {
                self.known(number, region.a.joint)?;
                self.known(number, region.b.joint)?;
                let is_bounded = !region.rows().is_empty() && region.bounds.iter().all(|(lower, upper)| lower <= upper);
                fit(number, (!is_bounded).then_some("a lower bound is above its upper one, or nothing is bounded"))
            }
            Constraint::Custom(own) => {
                own.0.frames().iter().try_for_each(|frame| self.known(number, frame.joint))?;
                fit(number, fits_rows(own.0.rows().len()))?;
                fit(number, own.0.rows().contains(&Row::Parameter).then_some("a function has no parameters"))
            }
        }
    }

    fn masses_known(&self, number: usize, masses: &Masses) -> Result<(), CompileError> {
        masses.bodies().iter().try_for_each(|heavy| self.known(number, heavy.body))?;
        let weighs = |heavy: &BodyMass| heavy.mass > 0.0 && heavy.mass.is_finite() && heavy.center.is_finite();
        let sound = masses.bodies().iter().all(weighs) && masses.total().is_finite();
        fit(number, (!sound).then_some("a mass is not a positive number at a finite place"))
    }

    pub(crate) fn name(&self, joint: JointIndex) -> String {
        self.robot.joints[joint.at()].name.clone()
    }

    /// Whether the joint is the root of something that moves freely.
    pub(crate) fn is_object(&self, joint: JointIndex) -> bool {
        let joint = &self.robot.joints[joint.at()];
        joint.parent.is_none() && joint.motion == JointType::FreeFlyer
    }
}
