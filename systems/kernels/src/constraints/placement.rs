//! An object on a support: which polygons touch, the five rows of contact and the three of its complement.
//!
//! The value is piecewise smooth: the pair of polygons and whether the object is over the support as it must be are found at
//! each evaluation and held constant in the Jacobian.

use super::relative_pose;
use crate::constraints::resting::{self, overhang};
use crate::constraints::rows_out::{RowsOut, placement_of};
use crate::kinematics::Column;
use foliate_components::Pose;
use foliate_components::constraint::{Placement, Rests, Row, Rows};
use foliate_components::pose::{exp_so3, log_so3};
use glam::{DVec2, DVec3};

/// The pair of polygons in contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    /// Index among the object's polygons.
    pub object: usize,
    /// Index among the supports' polygons.
    pub support: usize,
    /// Whether the object is over the support as the placement's rule asks: by [`Rests::Centre`] the centre of its polygon is above
    /// the inside of the support's.
    pub inside: bool,
}

/// The rows of contact as rows of a relative pose: outside, the centres are to meet.
const OUTSIDE: Rows = [Some(Row::Zero), Some(Row::Zero), Some(Row::Zero), None, Some(Row::Zero), Some(Row::Zero)];
/// The rows of the complement as rows of a relative pose: place and turn in the plane.
const IN_PLANE: Rows = [None, Some(Row::Parameter), Some(Row::Parameter), Some(Row::Parameter), None, None];

/// The pair of polygons that is nearest to contact (P0 eq. 3; the first wins a tie). Outside a support the distance to its
/// boundary counts, as in HPP; the paper takes the distance to its centre.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn contact(placement: &Placement, X_WJ: &[Pose]) -> Contact {
    let mut best = Contact { object: 0, support: 0, inside: false };
    let mut least = f64::INFINITY;
    for (object, lying) in placement.object.iter().enumerate() {
        let center = placement_of(&lying.frame).in_world(X_WJ).translation;
        for (support, carrying) in placement.supports.iter().enumerate() {
            let local = placement_of(&carrying.frame).in_world(X_WJ).inverse_transform_point(center);
            let (aside, inside) = if placement.rests == Rests::Centre {
                let aside = carrying.signed_distance(DVec2::new(local.y, local.z));
                (aside, aside < 0.0)
            } else {
                let X_SO = pose(placement, Contact { object, support, inside: false }, X_WJ);
                let over = overhang(placement, object, support, &X_SO);
                (over.map_or(0.0, |over| over.distance), over.is_none())
            };
            let cost = local.x * local.x + if inside { 0.0 } else { aside * aside };
            if cost < least {
                least = cost;
                best = Contact { object, support, inside };
            }
        }
    }
    best
}

/// The pose of the object's polygon in the support's.
///
/// # Panics
/// If `X_WJ` is too short or the contact is not of this placement.
#[must_use]
pub fn pose(placement: &Placement, contact: Contact, X_WJ: &[Pose]) -> Pose {
    let support = placement_of(&placement.supports[contact.support].frame);
    relative_pose::pose(&support, &placement_of(&placement.object[contact.object].frame), X_WJ)
}

/// The shortest way in the plane of the support, metres in the world, after which an object lies over it as the rule asks; see
/// [`resting::way_inside`].
///
/// # Panics
/// If `X_WJ` is too short or the contact is not of this placement.
#[must_use]
pub fn way_inside(placement: &Placement, contact: Contact, X_WJ: &[Pose]) -> Option<DVec3> {
    let way = resting::way_inside(placement, contact.object, contact.support, &pose(placement, contact, X_WJ))?;
    let support = placement_of(&placement.supports[contact.support].frame).in_world(X_WJ);
    Some(support.rotation * DVec3::new(0.0, way.x, way.y))
}

/// How far along its support an object has to go to lie over it as the rule asks, metres; by [`Rests::Centre`] to its middle.
///
/// # Panics
/// If `X_WJ` is too short or the contact is not of this placement.
#[must_use]
pub fn aside(placement: &Placement, contact: Contact, X_WJ: &[Pose]) -> f64 {
    let [_, y, z, ..] = value(placement, contact, X_WJ);
    let shortest = way_inside(placement, contact, X_WJ).map(DVec3::length);
    shortest.filter(|_| !contact.inside).unwrap_or_else(|| y.hypot(z))
}

/// P_f: `[x + margin, 0, 0, ry, rz]` inside, `[x + margin, y, z, ry, rz]` outside (P0 eq. 4). By other rules than [`Rests::Centre`]
/// y and z are not those of the support's centre but the error of [`overhang`].
///
/// # Panics
/// If `X_WJ` is too short or the contact is not of this placement.
#[must_use]
pub fn value(placement: &Placement, contact: Contact, X_WJ: &[Pose]) -> [f64; 5] {
    let support = placement_of(&placement.supports[contact.support].frame);
    let object = placement_of(&placement.object[contact.object].frame);
    let [x, y, z, _, turn_y, turn_z] = relative_pose::value(&support, &object, &aim(placement, contact, X_WJ), X_WJ);
    if contact.inside { [x, 0.0, 0.0, turn_y, turn_z] } else { [x, y, z, turn_y, turn_z] }
}

/// P̄_f: `[y + 2jM, z + 2iM, rx]` inside, `[2jM, 2iM, rx]` outside (P0 eq. 5; only by [`Rests::Centre`]), j the support, i the object's polygon: the
/// same numbers mean the same polygons.
///
/// # Panics
/// If `X_WJ` is too short or the contact is not of this placement.
#[must_use]
pub fn complement(placement: &Placement, contact: Contact, X_WJ: &[Pose]) -> [f64; 3] {
    let X_SO = pose(placement, contact, X_WJ);
    let is_free = contact.inside || placement.rests != Rests::Centre;
    let (y, z) = if is_free { (X_SO.translation.y, X_SO.translation.z) } else { (0.0, 0.0) };
    let stride = 2.0 * placement.stride;
    [y + contact.support as f64 * stride, z + contact.object as f64 * stride, log_so3(X_SO.rotation).x]
}

/// The complement as a leaf parameter: its first two rows as y and z of a translation, the third as a turn about x.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn parameter(placement: &Placement, X_WJ: &[Pose]) -> Pose {
    let [y, z, turn] = complement(placement, contact(placement, X_WJ), X_WJ);
    Pose::from_parts(DVec3::new(0.0, y, z), exp_so3(DVec3::X * turn))
}

/// Which polygons touch, and the pose of the object's in the support's, on the leaf of that parameter. `None` where the
/// parameter names a pair that the placement does not have.
#[must_use]
pub fn decode(placement: &Placement, parameter: &Pose) -> Option<(Contact, Pose)> {
    let stride = 2.0 * placement.stride;
    let (y, z) = (parameter.translation.y, parameter.translation.z);
    let (support, object) = ((y / stride + 0.5).floor(), (z / stride + 0.5).floor());
    let exists = |index: f64, count: usize| index >= 0.0 && index < count as f64;
    if !exists(support, placement.supports.len()) || !exists(object, placement.object.len()) {
        return None;
    }
    let (y, z) = (y - support * stride, z - object * stride);
    let (support, object) = (support as usize, object as usize);
    let X_SO = Pose::from_parts(DVec3::new(-placement.margin, y, z), parameter.rotation);
    let inside = match placement.rests {
        Rests::Centre => placement.supports[support].signed_distance(DVec2::new(y, z)) < 0.0,
        Rests::Stable { .. } | Rests::WholeFace { .. } => overhang(placement, object, support, &X_SO).is_none(),
    };
    Some((Contact { object, support, inside }, X_SO))
}

/// The pose of the object's body in the support's body (or in the world) on the leaf of that parameter: the explicit form
/// of contact and complement together.
#[must_use]
pub fn hold(placement: &Placement, parameter: &Pose) -> Option<(Contact, Pose)> {
    let (contact, X_SO) = decode(placement, parameter)?;
    let X_CS = placement.supports[contact.support].frame.joint_from_frame;
    let X_JO = placement.object[contact.object].frame.joint_from_frame;
    Some((contact, X_CS * X_SO * X_JO.inverse()))
}

/// Writes the five rows of contact and their Jacobian; `columns` are those of the object against the contact's support.
///
/// # Panics
/// If a slice is too short or the contact is not of this placement.
pub fn linearise(placement: &Placement, contact: Contact, columns: &[Column], X_WJ: &[Pose], out: RowsOut<'_>) {
    let RowsOut { values, jacobian, stride } = out;
    let rows = RowsOut { values: &mut *values, jacobian: &mut *jacobian, stride };
    linearise_pair(placement, contact, &aim(placement, contact, X_WJ), &OUTSIDE, columns, X_WJ, rows);
    if contact.inside {
        // Rows 1 and 2 stay in place as zeros: the number of rows does not depend on the configuration.
        values[1..3].fill(0.0);
        columns.iter().for_each(|c| jacobian[c.variable() * stride..][1..3].fill(0.0));
    }
}

/// Writes the three rows of the complement against the leaf parameter that [`decode`] has read, and their Jacobian.
///
/// # Panics
/// If a slice is too short or the contact is not of this placement.
pub fn linearise_complement(
    placement: &Placement,
    (contact, X_SO): &(Contact, Pose),
    columns: &[Column],
    X_WJ: &[Pose],
    out: RowsOut<'_>,
) {
    linearise_pair(placement, *contact, X_SO, &IN_PLANE, columns, X_WJ, out);
}

/// Writes all six rows of contact and complement against the leaf parameter that [`decode`] has read.
///
/// # Panics
/// If a slice is too short or the contact is not of this placement.
pub fn linearise_hold(
    placement: &Placement,
    (contact, X_SO): &(Contact, Pose),
    columns: &[Column],
    X_WJ: &[Pose],
    out: RowsOut<'_>,
) {
    linearise_pair(placement, *contact, X_SO, &[Some(Row::Parameter); 6], columns, X_WJ, out);
}

/// Where the object's polygon is to be in the support's where it touches and is not over it as it must: with both centres together,
/// or by another rule than [`Rests::Centre`] where [`overhang`] says.
fn aim(placement: &Placement, contact: Contact, X_WJ: &[Pose]) -> Pose {
    if placement.rests == Rests::Centre || contact.inside {
        return Pose::from_translation(DVec3::X * -placement.margin);
    }
    let X_SO = pose(placement, contact, X_WJ);
    let error = overhang(placement, contact.object, contact.support, &X_SO).map_or(DVec2::ZERO, |over| over.error);
    Pose::from_translation(DVec3::new(-placement.margin, X_SO.translation.y - error.x, X_SO.translation.z - error.y))
}

fn linearise_pair(
    placement: &Placement,
    contact: Contact,
    target: &Pose,
    rows: &Rows,
    columns: &[Column],
    X_WJ: &[Pose],
    out: RowsOut<'_>,
) {
    let support = placement_of(&placement.supports[contact.support].frame);
    let object = placement_of(&placement.object[contact.object].frame);
    relative_pose::linearise(&support, &object, target, rows, columns, X_WJ, out);
}
