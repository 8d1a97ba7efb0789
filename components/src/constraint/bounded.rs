//! What is measured between two frames and bounded by a number: distances, tilts, regions.

use super::{CentreOfMass, Frame, Masses, PlaneRow, Reference, Row};
use glam::DVec3;

/// The distance between the origins of two frames. The row is `|p_B − p_A| − length`, times −1 where `at_most`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// One point.
    pub a: Frame,
    /// The other.
    pub b: Frame,
    /// Metres, positive.
    pub length: f64,
    /// [`Row::Zero`], or [`Row::Inequality`] for "at least" (with `at_most`: "at most").
    pub row: Row,
    /// Which side of an inequality is allowed.
    pub at_most: bool,
}

/// The z axis of a frame is within an angle of the z axis of another: a cup that is kept upright.
///
/// With φ the angle between the axes, the row is `(cos φ − cos within) / sin within`, and must not be negative. It is smooth at all
/// angles. Where it is violated, its size is at least the sine of the angle that is too much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    /// The frame whose z axis is the reference: the world's for an object that is kept upright.
    pub a: Frame,
    /// The frame whose z axis tilts.
    pub b: Frame,
    /// The largest angle, radians, from [`Tilt::LEAST`] to [`Tilt::MOST`].
    pub within: f64,
}

impl Tilt {
    /// The smallest bound, radians: less is meant to be an equality, which a [`RelativePose`](super::RelativePose) says.
    pub const LEAST: f64 = 0.01;
    /// The largest bound, radians.
    pub const MOST: f64 = std::f64::consts::FRAC_PI_2;

    /// The axis, divided by the sine of the bound, is the difference of two points of B. Seen from A, the sum of that difference and
    /// the origin of A is the axis in the axes of A: one row on a weighted sum of points.
    #[must_use]
    pub fn as_weighted_sum(&self) -> CentreOfMass {
        let on_joint = &self.b.joint_from_frame;
        let tip = on_joint.translation + on_joint.rotation * (DVec3::Z / self.within.sin());
        let points = [(self.b, 1.0, tip), (self.b, -1.0, on_joint.translation), origin(&self.a, 1.0)];
        let row = PlaneRow { normal: DVec3::Z, offset: self.within.cos() / self.within.sin(), row: Row::Inequality };
        weighted_sum(&points, self.a, vec![row])
    }
}

/// The origin of a frame lies within a box: height limits, a corridor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// The frame whose axes the box has.
    pub a: Frame,
    /// The frame whose origin is bounded.
    pub b: Frame,
    /// By axis of A the lower and the upper bound, metres; infinite where there is none.
    pub bounds: [(f64, f64); 3],
}

impl Region {
    /// The half-spaces whose intersection the box is: as many as there are finite bounds.
    #[must_use]
    pub fn rows(&self) -> Vec<PlaneRow> {
        let row = |normal: DVec3, offset: f64| PlaneRow { normal, offset, row: Row::Inequality };
        let axis = |(axis, &(lower, upper)): (DVec3, &(f64, f64))| [row(axis, lower), row(-axis, -upper)];
        let rows = DVec3::AXES.into_iter().zip(&self.bounds).flat_map(axis);
        rows.filter(|row| row.offset.is_finite()).collect()
    }

    /// Its rows on the origin of B, as those of a weighted sum of points.
    #[must_use]
    pub fn as_weighted_sum(&self) -> CentreOfMass {
        weighted_sum(&[origin(&self.b, 1.0)], self.a, self.rows())
    }
}

fn origin(frame: &Frame, weight: f64) -> (Frame, f64, DVec3) {
    (*frame, weight, frame.joint_from_frame.translation)
}

/// Rows on a sum of points (a body by a frame on it, a weight, the point in the joint frame of the body). The weights sum up to 1.
fn weighted_sum(points: &[(Frame, f64, DVec3)], frame: Frame, rows: Vec<PlaneRow>) -> CentreOfMass {
    let points = points.iter().map(|&(on, weight, point)| (on.joint, weight, point));
    CentreOfMass { masses: Masses::of_points(points), frame, rows, reference: Reference::Identity }
}

#[cfg(test)]
mod tests {
    #![allow(non_snake_case, reason = "X_AB notation")]

    use super::*;
    use crate::Pose;
    use crate::pose::exp_so3;

    /// The row as its sum says it, where A and B have poses in the world.
    fn value(sum: &CentreOfMass, X_WA: &Pose) -> f64 {
        let centre: DVec3 = sum.masses.bodies().iter().map(|point| point.mass * point.center).sum();
        let row = sum.rows[0];
        row.normal.dot(X_WA.inverse_transform_point(centre)) - row.offset
    }

    #[test]
    fn a_tilt_is_measured_from_the_axis_of_its_reference_wherever_both_frames_are() {
        let X_WA = Pose::from_parts(DVec3::new(3.0, -2.0, 0.5), exp_so3(DVec3::new(0.3, -0.7, 1.1)));
        for (angle, within) in [(0.0, 0.2), (0.1, 0.2), (0.2, 0.2), (0.25, 0.2), (3.0, 1.2), (1.0, Tilt::MOST)] {
            let turned = exp_so3(DVec3::Z * 0.8) * exp_so3(DVec3::X * angle);
            let X_WB = Pose::from_parts(DVec3::new(-1.0, 4.0, 2.0), X_WA.rotation * turned);
            let tilt = Tilt { a: Frame::world(X_WA), b: Frame::world(X_WB), within };
            let found = value(&tilt.as_weighted_sum(), &X_WA);
            let wanted = (f64::cos(angle) - within.cos()) / within.sin();
            assert!((found - wanted).abs() < 1e-12, "{angle} {within}: {found} {wanted}");
            assert!(angle <= within || -found >= (angle - within).min(1.5).sin() - 1e-12);
        }
    }

    #[test]
    fn a_region_has_a_half_space_for_each_bound() {
        let bounds = [(f64::NEG_INFINITY, 0.5), (-0.1, 0.2), (f64::NEG_INFINITY, f64::INFINITY)];
        let region = Region { a: Frame::world(Pose::identity()), b: Frame::world(Pose::identity()), bounds };
        let rows = region.rows();
        let said: Vec<_> = rows.iter().map(|row| (row.normal, row.offset)).collect();
        assert_eq!(said, [(-DVec3::X, -0.5), (DVec3::Y, -0.1), (-DVec3::Y, -0.2)]);
        assert!(rows.iter().all(|row| row.row == Row::Inequality));
    }
}
