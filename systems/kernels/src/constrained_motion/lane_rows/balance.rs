//! Balance in lanes: where a centre of mass is, and how joints move it, as `centre_of_mass` and `com_between` say it of one
//! configuration.

use crate::constrained_motion::lane_rows::form::{LaneBalance, LaneMasses, LaneStance};
use crate::constrained_motion::lane_rows::slots::{At, Out, frame};
use crate::constraints::com_between::CLOSEST;
use crate::kinematics::LaneColumn;
use crate::kinematics::lane_steps::POSE_ROWS;
use crate::lanes::{Lanes, Mask, Vector3};
use foliate_components::constraint::Row;
use glam::DVec3;

/// Writes the moment of the points beyond each node, three rows each, and answers that of all points.
#[inline(always)]
fn moments<V: Lanes>(isa: V::Isa, masses: &LaneMasses, at: At<'_, V::Row>, moments: &mut [V::Row]) -> Vector3<V> {
    let zero = V::constant(isa, 0.0);
    for row in &mut moments[..3 * masses.nodes.len()] {
        zero.store(row);
    }
    let mut total = Vector3::splat(isa, masses.still);
    for point in &masses.points {
        let body = frame::<V>(isa, &point.body, at);
        let on_body = body.rotation.turn(Vector3::splat(isa, point.weighted));
        let moment = body.translation.scaled_plus(V::constant(isa, point.weight), on_body);
        match point.node {
            Some(node) => {
                let rows = &mut moments[3 * node..];
                moment.plus(Vector3::load(isa, rows)).store(rows);
            }
            None => total = total.plus(moment),
        }
    }
    for (index, parent) in masses.nodes.iter().enumerate().rev() {
        let beyond = Vector3::load(isa, &moments[3 * index..]);
        match parent {
            Some(parent) => {
                let rows = &mut moments[3 * parent..];
                beyond.plus(Vector3::load(isa, rows)).store(rows);
            }
            None => total = total.plus(beyond),
        }
    }
    total
}

/// Writes the rows of a centre of mass in a frame. A satisfied inequality has value and Jacobian zero.
#[inline(always)]
pub(crate) fn linearise_balance<V: Lanes>(
    isa: V::Isa,
    balance: &LaneBalance,
    at: At<'_, V::Row>,
    out: &mut Out<'_, V::Row>,
) {
    let zero = V::constant(isa, 0.0);
    let own = frame::<V>(isa, &balance.frame, at);
    let center = moments(isa, &balance.masses, at, out.vectors);
    let center = own.rotation.turn_back(center.minus(own.translation));
    let reference = match balance.reference {
        Some(slot) => Vector3::load(isa, &at.given[slot * POSE_ROWS + 9..]),
        None => Vector3::splat(isa, DVec3::ZERO),
    };
    let (moments, gradients) = out.vectors.split_at_mut(3 * balance.masses.nodes.len());
    let values = &mut out.values[balance.first..];
    for (k, plane) in balance.planes.iter().enumerate() {
        let normal = Vector3::splat(isa, plane.normal);
        let from = if plane.row == Row::Parameter { center.minus(reference) } else { center };
        let mut value = normal.dot(from) - V::constant(isa, plane.offset);
        let mut gradient = own.rotation.turn(normal);
        if plane.row == Row::Inequality {
            let satisfied = zero.le(value);
            value = V::select(satisfied, zero, value);
            gradient = Vector3::select(satisfied, Vector3::splat(isa, DVec3::ZERO), gradient);
        }
        value.store(&mut values[k]);
        gradient.store(&mut gradients[3 * k..]);
    }
    if out.values_alone {
        return;
    }
    for moment in &balance.masses.columns {
        let beyond = (Vector3::load(isa, &moments[3 * moment.node..]), moment.weight);
        let velocity = moment.column.moment_velocity::<V>(isa, at.bodies, at.given, beyond);
        let numbers = &mut out.jacobian[moment.column.variable * out.stride + balance.first..];
        for k in 0..balance.planes.len() {
            let rate = Vector3::load(isa, &gradients[3 * k..]).dot(velocity);
            (rate + V::load(isa, &numbers[k])).store(&mut numbers[k]);
        }
    }
}

/// Writes the rows of a centre of mass between two feet. A satisfied inequality has value and Jacobian zero.
// Long: one formula, whose terms share their subexpressions.
#[inline(always)]
pub(crate) fn linearise_stance<V: Lanes>(
    isa: V::Isa,
    stance: &LaneStance,
    at: At<'_, V::Row>,
    out: &mut Out<'_, V::Row>,
) {
    let (zero, one, half) = (V::constant(isa, 0.0), V::constant(isa, 1.0), V::constant(isa, 0.5));
    let feet = [frame::<V>(isa, &stance.feet[0], at).translation, frame::<V>(isa, &stance.feet[1], at).translation];
    let center = moments(isa, &stance.masses, at, out.vectors);
    let (dx, dy) = (feet[1].x - feet[0].x, feet[1].y - feet[0].y);
    let apart = dx.mul_add(dx, dy * dy).sqrt();
    // Feet above each other have no line between them: its direction then stays.
    let close = apart.lt(V::constant(isa, CLOSEST));
    let per_metre = V::select(close, zero, one / apart.max(V::constant(isa, CLOSEST)));
    let along = Vector3::new(V::select(close, one, dx * per_metre), dy * per_metre, zero);
    let sideways = Vector3::new(-along.y, along.x, zero);
    let turning = sideways.scaled(per_metre);
    let (from_first, to_second) = (center.minus(feet[0]), feet[1].minus(center));
    let (aside, beyond, before) = (sideways.dot(from_first), along.dot(from_first), along.dot(to_second));
    let up = Vector3::splat(isa, DVec3::Z);
    let nothing = Vector3::splat(isa, DVec3::ZERO);
    let above = center.z - half * (feet[0].z + feet[1].z) - V::constant(isa, stance.height.unwrap_or(0.0));
    let mut values = [above, aside, beyond, before];
    // By row: with the motions of the centre of mass, of the first foot and of the second.
    let mut gradients = [
        [up, up.scaled(-half), up.scaled(-half)],
        [sideways, turning.scaled(beyond).minus(sideways), turning.scaled(-beyond)],
        [along, turning.scaled(-aside).minus(along), turning.scaled(aside)],
        [
            along.negated(),
            turning.scaled(-sideways.dot(to_second)),
            turning.scaled_plus(sideways.dot(to_second), along),
        ],
    ];
    for row in 2..4 {
        let satisfied = zero.le(values[row]);
        if satisfied.any() {
            values[row] = V::select(satisfied, zero, values[row]);
            for gradient in &mut gradients[row] {
                *gradient = Vector3::select(satisfied, nothing, *gradient);
            }
        }
    }
    let skipped = usize::from(stance.height.is_none());
    for (value, row) in values[skipped..].iter().zip(&mut out.values[stance.first..]) {
        value.store(row);
    }
    let gradients = &gradients[skipped..];
    if out.values_alone {
        return;
    }
    for moment in &stance.masses.columns {
        let beyond = (Vector3::load(isa, &out.vectors[3 * moment.node..]), moment.weight);
        let velocity = moment.column.moment_velocity::<V>(isa, at.bodies, at.given, beyond);
        let numbers = &mut out.jacobian[moment.column.variable * out.stride + stance.first..];
        for (gradient, number) in gradients.iter().zip(numbers) {
            (gradient[0].dot(velocity) + V::load(isa, number)).store(number);
        }
    }
    for foot in 0..2 {
        let columns: &[LaneColumn] = &stance.columns[foot];
        for column in columns {
            let (velocity, _) = column.twist::<V>(isa, at.bodies, at.given, feet[foot]);
            let numbers = &mut out.jacobian[column.variable * out.stride + stance.first..];
            for (gradient, number) in gradients.iter().zip(numbers) {
                (gradient[foot + 1].dot(velocity) + V::load(isa, number)).store(number);
            }
        }
    }
}
