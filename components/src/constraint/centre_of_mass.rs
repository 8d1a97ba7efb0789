//! The centre of mass of some bodies, seen from frames: quasi-static balance (P0 §IV-A d).

use super::{Frame, Reference, Row};
use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{JointIndex, PartIndex};
use glam::DVec3;
use std::sync::Arc;

/// What is heavy on one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMass {
    /// The body; `None` where it is fixed in the world.
    pub body: Option<JointIndex>,
    /// Kilograms, positive; the weight of a point of a [`Tilt`](super::Tilt) or [`Region`](super::Region) has no unit.
    pub mass: f64,
    /// Centre of that mass in the body's joint frame, metres.
    pub center: DVec3,
}

/// The masses whose common centre is constrained.
#[derive(Clone, Debug, PartialEq)]
pub struct Masses {
    parts: Arc<[PartIndex]>,
    bodies: Arc<[BodyMass]>,
}

/// Why parts have no centre of mass.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no link of {0} has a mass; give them `<inertial>` elements")]
pub struct NoMass(pub String);

impl Masses {
    /// Sums up the links of parts, body by body.
    ///
    /// # Errors
    /// Parts without any mass.
    ///
    /// # Panics
    /// If the robot has no such part.
    pub fn of_parts(robot: &Robot, parts: &[PartIndex]) -> Result<Self, NoMass> {
        let mut bodies: Vec<BodyMass> = Vec::new();
        for link in parts.iter().flat_map(|part| robot.parts[part.at()].links.clone()) {
            let link = &robot.links[link];
            let Some(inertial) = link.inertial.filter(|inertial| inertial.mass > 0.0) else { continue };
            let center = link.joint_from_link * inertial.center;
            match bodies.iter_mut().find(|b| b.body == link.joint) {
                Some(b) => {
                    let mass = b.mass + inertial.mass;
                    b.center = (b.center * b.mass + center * inertial.mass) / mass;
                    b.mass = mass;
                }
                None => bodies.push(BodyMass { body: link.joint, mass: inertial.mass, center }),
            }
        }
        if bodies.is_empty() {
            let names: Vec<_> = parts.iter().map(|p| format!("`{}`", robot.parts[p.at()].name)).collect();
            return Err(NoMass(names.join(", ")));
        }
        Ok(Self { parts: parts.into(), bodies: bodies.into() })
    }

    /// Points of bodies with weights of any sign that sum up to 1 (body, weight, place in its joint frame): what is a weighted sum of
    /// points is handled as a centre of mass.
    pub(crate) fn of_points(points: impl Iterator<Item = (Option<JointIndex>, f64, DVec3)>) -> Self {
        let bodies = points.map(|(body, mass, center)| BodyMass { body, mass, center }).collect();
        Self { parts: Arc::default(), bodies }
    }

    /// The parts whose links were summed up; none for the points of a [`Tilt`](super::Tilt) or [`Region`](super::Region).
    #[must_use]
    pub fn parts(&self) -> &[PartIndex] {
        &self.parts
    }

    /// The bodies; at least one.
    #[must_use]
    pub fn bodies(&self) -> &[BodyMass] {
        &self.bodies
    }

    /// Their total, kilograms.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.bodies.iter().map(|b| b.mass).sum()
    }
}

/// One row on the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneRow {
    /// The row is `normal · c − offset` (metres), c the centre of mass in the frame; a parameter row measures from the
    /// translation of its argument instead of the origin. Unit length.
    pub normal: DVec3,
    /// Metres.
    pub offset: f64,
    /// What is asked of it.
    pub row: Row,
}

/// The centre of mass in a frame: fixed components (HPP's relative centre of mass), or half-spaces that bound it (a
/// support polygon on one foot).
#[derive(Clone, Debug, PartialEq)]
pub struct CentreOfMass {
    /// What is heavy.
    pub masses: Masses,
    /// The frame in which it is read.
    pub frame: Frame,
    /// At least one.
    pub rows: Vec<PlaneRow>,
    /// Where parameter rows are measured from.
    pub reference: Reference,
}

/// The centre of mass over the line between two frames (HPP's `ComBetweenFeet`): balance on both feet, wherever they
/// stand.
///
/// Rows, in metres, with u the horizontal direction from the first frame's origin to the second's:
/// `[c_z − mid_z − height, sideways distance of c from the line, c·u − first·u, second·u − c·u]`; the last two are
/// inequalities, "z" and "sideways" are those of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct CentreOfMassBetween {
    /// What is heavy.
    pub masses: Masses,
    /// One foot.
    pub first: Frame,
    /// The other.
    pub second: Frame,
    /// Height of the centre of mass above the middle of the two origins; free where `None`.
    pub height: Option<f64>,
}
