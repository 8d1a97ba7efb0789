//! How a solve changes a configuration: which coordinate each variable moves, which are locked, and where eliminated objects and
//! roots are written.
//!
//! These are plain data with their arithmetic. `program/assembly.rs` makes them, and the solvers apply them.

use foliate_components::Pose;
use foliate_components::constraint::LockedValue;
use foliate_components::pose::log_so3;
use foliate_components::robot::JointIndex;
use glam::DVec3;

impl Move {
    /// The variable and the side (−1 lower, 1 upper) where the coordinate is at a bound. Coordinates are clamped onto
    /// their bounds exactly; the tolerance catches starts that are a rounding error inside.
    pub(crate) fn at_bound(&self, q: &[f64]) -> Option<(usize, f64)> {
        let Self::Scalar { variable, coordinate, lower, upper } = *self else { return None };
        let slack = 1e-12;
        if q[coordinate] >= upper - slack {
            Some((variable, 1.0))
        } else if q[coordinate] <= lower + slack {
            Some((variable, -1.0))
        } else {
            None
        }
    }
}

/// An eliminated root.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StandingRoot {
    pub write: WriteBack,
    /// Bounds of its position in its joint frame.
    pub lower: DVec3,
    pub upper: DVec3,
}

/// How active variables move a configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Move {
    /// q[coordinate] += step[variable], within bounds.
    Scalar { variable: usize, coordinate: usize, lower: f64, upper: f64 },
    /// The quaternion of the free-flyer whose seven numbers start at `coordinate`, by a rotation vector in the moving
    /// frame whose first component is `variable`.
    Turn { variable: usize, coordinate: usize },
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct LockedCoordinate {
    pub coordinate: usize,
    pub value: LockedValue,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct WriteBack {
    pub object: JointIndex,
    /// First of the object's seven numbers.
    pub coordinate: usize,
    /// X_JW of the object's root joint; `None` where that is the identity, so that poses are copied bit for bit.
    pub X_JW: Option<Pose>,
}

/// What a root may be outside of its bounds by for want of digits, metres.
const ROUNDING: f64 = 1e-9;

impl StandingRoot {
    /// Writes the root with the sign of the quaternion that it had, so that a motion's knots have no jumps of sign.
    pub(crate) fn write(&self, X_WJ: &[Pose], q: &mut [f64]) {
        let i = self.write.coordinate;
        let before = foliate_components::robot::configuration::quaternion(q, i);
        self.write.write(X_WJ, q);
        let turn = foliate_components::robot::configuration::quaternion(q, i).normalize();
        let turn = if turn.dot(before) < 0.0 { -turn } else { turn };
        q[i + 3..i + 7].copy_from_slice(&[turn.x, turn.y, turn.z, turn.w]);
        for k in 0..3 {
            let within = q[i + k].max(self.lower[k]).min(self.upper[k]);
            if (within - q[i + k]).abs() <= ROUNDING {
                q[i + k] = within;
            }
        }
    }

    pub(crate) fn is_within(&self, q: &[f64]) -> bool {
        let i = self.write.coordinate;
        (0..3).all(|k| (self.lower[k]..=self.upper[k]).contains(&q[i + k]))
    }
}

/// The largest absolute value; infinite where one of them is not a number.
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most: f64, v| if v.is_nan() { f64::INFINITY } else { most.max(v.abs()) })
}

impl WriteBack {
    fn pose(&self, X_WJ: &[Pose]) -> Pose {
        match self.X_JW {
            None => X_WJ[self.object.at()],
            Some(X_JW) => X_JW * X_WJ[self.object.at()],
        }
    }

    pub(crate) fn write(&self, X_WJ: &[Pose], q: &mut [f64]) {
        let pose = self.pose(X_WJ);
        let (t, r) = (pose.translation, pose.rotation);
        q[self.coordinate..self.coordinate + 7].copy_from_slice(&[t.x, t.y, t.z, r.x, r.y, r.z, r.w]);
    }

    pub(crate) fn distance(&self, q: &[f64], X_WJ: &[Pose]) -> f64 {
        let (i, pose) = (self.coordinate, self.pose(X_WJ));
        let apart = DVec3::new(q[i], q[i + 1], q[i + 2]) - pose.translation;
        let turned = foliate_components::robot::configuration::quaternion(q, i).conjugate() * pose.rotation;
        apart.abs().max_element().max(log_so3(turned).abs().max_element())
    }
}
