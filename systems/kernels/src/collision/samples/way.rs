//! Where a sample's configuration comes from: a knot, a straight piece, or a piece of a curve.

use crate::curve::cubic::Cubic;
use crate::kinematics::joint_table::JointCoordinates;
use foliate_components::pose::exp_so3;
use foliate_components::robot::configuration::quaternion;
use glam::{DQuat, DVec3};

/// A place of a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Way<'a> {
    Knot(&'a [f64]),
    /// From a configuration by a difference, times t.
    Straight(&'a [f64], &'a [f64], f64),
    /// The coordinates' polynomials, at t.
    Curve(&'a [Cubic], f64),
}

impl Way<'_> {
    /// One of a joint's coordinates that are no part of a quaternion.
    #[inline]
    pub(crate) fn number(&self, joint: JointCoordinates, i: usize) -> f64 {
        match *self {
            Self::Knot(q) => q[joint.q + i],
            Self::Straight(q, delta, t) => q[joint.q + i] + t * delta[joint.v + i],
            Self::Curve(cubics, t) => cubics[joint.q + i].at(t),
        }
    }

    /// The rotation of a free-flyer.
    #[inline]
    pub(crate) fn rotation(&self, joint: JointCoordinates) -> DQuat {
        let turned = match *self {
            Self::Knot(q) => quaternion(q, joint.q),
            Self::Straight(q, d, t) => {
                let v = joint.v + 3;
                quaternion(q, joint.q) * exp_so3(DVec3::new(d[v], d[v + 1], d[v + 2]) * t)
            }
            Self::Curve(cubics, t) => DQuat::from_array([3, 4, 5, 6].map(|i| cubics[joint.q + i].at(t))),
        };
        turned.normalize()
    }
}
