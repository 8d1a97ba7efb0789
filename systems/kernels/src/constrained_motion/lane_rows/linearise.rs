//! Values and Jacobians of rows in lanes: relative poses, and placements with their polygons chosen lane by lane. (Balance has
//! a file of its own.)

use crate::constrained_motion::lane_rows::balance::{linearise_balance, linearise_stance};
use crate::constrained_motion::lane_rows::form::{LaneContact, LanePose, LaneRows, LaneSupport, RowsAt, Target};
use crate::constrained_motion::lane_rows::slots::{At, Out, frame, select};
use crate::kinematics::lane_jacobian::LaneColumn;
use crate::kinematics::lane_steps::POSE_ROWS;
use crate::lanes::geometry::{Rotation, Transform, Vector3};
use crate::lanes::trigonometry::atan_ratio;
use crate::lanes::vector::{Lanes, Mask, Scalar};
use foliate_components::Pose;

/// Six errors with what turns velocities into their rates: `slide` takes those of points into the rows' axes, `turn` angular
/// ones.
struct Six<V> {
    values: [V; 6],
    /// Axes of the translation rows, by columns.
    slide: Rotation<V>,
    /// Rows of the matrix that takes an angular velocity to the rate of the rotation vector.
    turn: [Vector3<V>; 3],
}

/// Writes a block's rows. Answers the lanes (bits) in which rows 1 and 2 of a contact are at rest; all lanes where there is
/// no contact.
#[inline(always)]
pub(crate) fn linearise<V: Lanes>(
    isa: V::Isa,
    rows: &LaneRows,
    at: At<'_, V::Row>,
    running: V::Mask,
    out: &mut Out<'_, V::Row>,
) -> V::Mask {
    match rows {
        LaneRows::Pose(pose) => {
            linearise_pose::<V>(isa, pose, at, running, out);
            running
        }
        LaneRows::Contact(contact) => linearise_contact::<V>(isa, contact, at, running, out),
        LaneRows::Balance(balance) => {
            linearise_balance::<V>(isa, balance, at, out);
            running
        }
        LaneRows::Stance(stance) => {
            linearise_stance::<V>(isa, stance, at, out);
            running
        }
    }
}

#[inline(always)]
fn linearise_pose<V: Lanes>(
    isa: V::Isa,
    pose: &LanePose,
    at: At<'_, V::Row>,
    running: V::Mask,
    out: &mut Out<'_, V::Row>,
) {
    let (a, b) = (frame::<V>(isa, &pose.a, at), frame::<V>(isa, &pose.b, at));
    let target = match &pose.target {
        Target::Frame => a,
        Target::Given(slot) => Transform::load(isa, &at.given[slot * POSE_ROWS..]),
        Target::Fixed(reference) => a.times(&Transform::splat(isa, reference)),
        Target::Reference(slot) => a.times(&Transform::load(isa, &at.given[slot * POSE_ROWS..])),
    };
    let six = compare(isa, &a.rotation, &target, &b, pose.out.turns(), running);
    // A satisfied inequality has value and Jacobian zero.
    let mut weight = [V::constant(isa, 1.0); 6];
    let mut values = six.values;
    let mut weighted = false;
    for k in 0..6 {
        if pose.out.inequality[k] {
            let zero = V::constant(isa, 0.0);
            let satisfied = zero.le(values[k]);
            weight[k] = V::select(satisfied, zero, weight[k]);
            values[k] = V::select(satisfied, zero, values[k]);
            weighted = true;
        }
    }
    let weight = if weighted { Some(weight) } else { None };
    write(isa, &Six { values, ..six }, weight, &pose.out, &pose.columns, at, b.translation, out);
}

#[inline(always)]
fn linearise_contact<V: Lanes>(
    isa: V::Isa,
    contact: &LaneContact,
    at: At<'_, V::Row>,
    running: V::Mask,
    out: &mut Out<'_, V::Row>,
) -> V::Mask {
    let zero = V::constant(isa, 0.0);
    let mut least = V::splat(isa, V::Scalar::MAX);
    let mut support = Transform::<V>::splat(isa, &Pose::identity());
    let mut object = support;
    let mut inside = zero.lt(zero);
    // The pair that is nearest to contact; the first wins a tie, as in the scalar code.
    for lying in &contact.objects {
        let lying = frame::<V>(isa, lying, at);
        for carrying in &contact.supports {
            let own = frame::<V>(isa, &carrying.frame, at);
            let local = own.rotation.turn_back(lying.translation.minus(own.translation));
            let aside = signed_distance::<V>(isa, carrying, local.y, local.z);
            let above = aside.lt(zero);
            let cost = local.x.mul_add(local.x, V::select(above, zero, aside * aside));
            let nearer = cost.lt(least);
            least = V::select(nearer, cost, least);
            support = select(nearer, &own, &support);
            object = select(nearer, &lying, &object);
            inside = (nearer & above) | (!nearer & inside);
        }
    }
    let margin = V::constant(isa, contact.margin);
    let target = Transform {
        rotation: support.rotation,
        translation: support.rotation.columns[0].scaled_from(margin, support.translation),
    };
    let mut six = compare(isa, &support.rotation, &target, &object, true, running);
    let one = V::constant(isa, 1.0);
    let outside = V::select(inside, zero, one);
    six.values[1] = V::select(inside, zero, six.values[1]);
    six.values[2] = V::select(inside, zero, six.values[2]);
    let weight = Some([one, outside, outside, one, one, one]);
    let f = contact.first;
    let rows = RowsAt { row: [f, f + 1, f + 2, usize::MAX, f + 3, f + 4], inequality: [false; 6] };
    write(isa, &six, weight, &rows, &contact.columns, at, object.translation, out);
    inside
}

/// Signed distance from the polygon's boundary to (y, z), negative inside.
#[inline(always)]
fn signed_distance<V: Lanes>(isa: V::Isa, support: &LaneSupport, y: V, z: V) -> V {
    let (zero, one) = (V::constant(isa, 0.0), V::constant(isa, 1.0));
    let mut deepest = -V::splat(isa, V::Scalar::MAX);
    let mut squared = V::splat(isa, V::Scalar::MAX);
    for edge in &support.edges {
        let (dy, dz) = (y - V::constant(isa, edge.start.x), z - V::constant(isa, edge.start.y));
        let beyond = dy.mul_add(V::constant(isa, edge.normal.x), dz * V::constant(isa, edge.normal.y));
        deepest = deepest.max(beyond);
        let (ay, az) = (V::constant(isa, edge.along.x), V::constant(isa, edge.along.y));
        let share = dy.mul_add(ay, dz * az) * V::constant(isa, edge.per_length);
        let share = share.max(zero).min(one);
        let (ry, rz) = (ay.neg_mul_add(share, dy), az.neg_mul_add(share, dz));
        squared = squared.min(ry.mul_add(ry, rz * rz));
    }
    V::select(deepest.le(zero), deepest, squared.sqrt())
}

/// The pose of B against a target, with translations along the axes `a`.
#[inline(always)]
fn compare<V: Lanes>(
    isa: V::Isa,
    a: &Rotation<V>,
    target: &Transform<V>,
    b: &Transform<V>,
    turns: bool,
    running: V::Mask,
) -> Six<V> {
    let zero = V::constant(isa, 0.0);
    let apart = a.turn_back(b.translation.minus(target.translation));
    let nothing = Vector3::new(zero, zero, zero);
    if !turns {
        let values = [apart.x, apart.y, apart.z, zero, zero, zero];
        return Six { values, slide: *a, turn: [nothing; 3] };
    }
    let rest = target.rotation.transpose_times(&b.rotation);
    let (vector, rate) = log(isa, &rest, running);
    // The rate of the rotation vector by an angular velocity in the world: J · R_targetᵀ, row by row.
    let turn = [target.rotation.turn(rate[0]), target.rotation.turn(rate[1]), target.rotation.turn(rate[2])];
    Six { values: [apart.x, apart.y, apart.z, vector.x, vector.y, vector.z], slide: *a, turn }
}

/// The rotation vector of R, and the rows of J with d log(R)/dt = J·ω, ω in the fixed frame (the inverse left Jacobian of
/// SO(3), as `log_so3_jacobian`).
#[inline(always)]
fn log<V: Lanes>(isa: V::Isa, r: &Rotation<V>, running: V::Mask) -> (Vector3<V>, [Vector3<V>; 3]) {
    let (half, one, zero) = (V::constant(isa, 0.5), V::constant(isa, 1.0), V::constant(isa, 0.0));
    let [x, y, z] = r.columns;
    // sin θ · axis and cos θ: precise for small turns, which a quaternion of the diagonal would not be.
    let v = Vector3::new((y.z - z.y) * half, (z.x - x.z) * half, (x.y - y.x) * half);
    let cosine = ((x.x + y.y + z.z) - one) * half;
    let sine = v.dot(v).sqrt().max(V::constant(isa, 1e-30));
    let angle = atan_ratio(sine, cosine);
    let per_sine = angle / sine;
    let mut vector = v.scaled(per_sine);
    // Next to half a turn the sine says nothing of the axis; the symmetric part (R + Rᵀ)/2 = cos θ + (1 − cos θ) a·aᵀ does.
    let near = V::constant(isa, 1e3 * V::Scalar::EPSILON.to_f64().sqrt());
    let half_turn = cosine.lt(zero) & sine.lt(near) & running;
    if half_turn.any() {
        let off = |a: V, b: V| (a + b) * half;
        let (xy, xz, yz) = (off(x.y, y.x), off(x.z, z.x), off(y.z, z.y));
        let (xx, yy, zz) = (x.x - cosine, y.y - cosine, z.z - cosine);
        let first = yy.le(xx) & zz.le(xx);
        let second = zz.le(yy);
        let column = Vector3::select(
            first,
            Vector3::new(xx, xy, xz),
            Vector3::select(second, Vector3::new(xy, yy, yz), Vector3::new(xz, yz, zz)),
        );
        let length = column.dot(column).sqrt();
        let sign = one.copysign(column.dot(v));
        vector = Vector3::select(half_turn, column.scaled(sign * angle / length), vector);
    }
    let squared = angle * angle;
    // (1 − θ/2 · cot(θ/2))/θ², and its series where the difference would lose digits.
    let series = squared.mul_add(
        squared.mul_add(V::constant(isa, 1.0 / 30_240.0), V::constant(isa, 1.0 / 720.0)),
        V::constant(isa, 1.0 / 12.0),
    );
    let closed = (one - half * per_sine * (one + cosine)) / squared;
    let small = squared.lt(V::constant(isa, 1e-3));
    let c = V::select(small, series, closed);
    let diagonal = |e: V| c.mul_add(e.mul_sub(e, squared), one);
    let (xx, yy, zz) = (diagonal(vector.x), diagonal(vector.y), diagonal(vector.z));
    let scaled = vector.scaled(c);
    let (xy, xz, yz) = (scaled.x * vector.y, scaled.x * vector.z, scaled.y * vector.z);
    let h = vector.scaled(half);
    let rows = [
        Vector3::new(xx, xy + h.z, xz - h.y),
        Vector3::new(xy - h.z, yy, yz + h.x),
        Vector3::new(xz + h.y, yz - h.x, zz),
    ];
    (vector, rows)
}

#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "inlined once per kind of rows")]
fn write<V: Lanes>(
    isa: V::Isa,
    six: &Six<V>,
    weight: Option<[V; 6]>,
    rows: &RowsAt,
    columns: &[LaneColumn],
    at: At<'_, V::Row>,
    point: Vector3<V>,
    out: &mut Out<'_, V::Row>,
) {
    for k in 0..6 {
        if rows.row[k] != usize::MAX {
            six.values[k].store(&mut out.values[rows.row[k]]);
        }
    }
    if out.values_alone {
        return;
    }
    let (slides, turns) = (rows.slides(), rows.turns());
    let zero = V::constant(isa, 0.0);
    for column in columns {
        let (linear, angular) = column.twist::<V>(isa, at.bodies, at.given, point);
        let mut rates = [zero; 6];
        if slides {
            let linear = six.slide.turn_back(linear);
            rates[0] = linear.x;
            rates[1] = linear.y;
            rates[2] = linear.z;
        }
        if turns && let Some(angular) = angular {
            rates[3] = six.turn[0].dot(angular);
            rates[4] = six.turn[1].dot(angular);
            rates[5] = six.turn[2].dot(angular);
        }
        if let Some(weight) = weight {
            for k in 0..6 {
                rates[k] = rates[k] * weight[k];
            }
        }
        let numbers = &mut out.jacobian[column.variable * out.stride..];
        for k in 0..6 {
            if rows.row[k] != usize::MAX {
                let number = &mut numbers[rows.row[k]];
                let rate = if out.adds { rates[k] + V::load(isa, number) } else { rates[k] };
                rate.store(number);
            }
        }
    }
}
