//! Bounds on the distance of two placed solids, in lanes.
//!
//! `beside_box`, `form_along`, `reach_along` and `between_axes` give lower bounds of the distance from the bounding volumes. `overlap`
//! gives a lower bound of the penetration from the inscribed capsules. All are pure functions of placed rows; which bounds to
//! try, and in which order, is decided in `block_of_samples`.

use crate::collision::samples::interval::POSE;
use crate::collision::scene::bounding::{BoundingVolume, Form};
use crate::collision::scene::inscribed::InscribedVolume;
use crate::lanes::geometry::{Rotation, Vector3};
use crate::lanes::vector::Lanes;
use crate::lanes::vector::{F32Row, Isa};

/// At least this far apart are a box and what stands at `at` in its frame: the distance of the box to the other's bounding
/// box along its axes.
#[inline(always)]
pub(crate) fn beside_box<I: Isa>(
    isa: I,
    own: &BoundingVolume,
    axes: &Rotation<I::F32>,
    other: &BoundingVolume,
    others: &Rotation<I::F32>,
    at: Vector3<I::F32>,
) -> I::F32 {
    let Form::Box(half) = own.form else { return I::F32::constant(isa, f64::NEG_INFINITY) };
    let [x, y, z] = axes.columns;
    // No closures around vectors: they are compiled without the instructions of the level, and each operation is a call.
    let x = form_along(isa, &other.form, others, x);
    let y = form_along(isa, &other.form, others, y);
    let z = form_along(isa, &other.form, others, z);
    outside_box(isa, half, [x, y, z], at)
}

/// As [`beside_box`] of two boxes, of either beside the other: the larger. `apart` is from the centre of the second to that of the first,
/// in the world.
#[inline(always)]
pub(crate) fn beside_boxes<I: Isa>(
    isa: I,
    [half_a, half_b]: [[f32; 3]; 2],
    [a, b]: [&Rotation<I::F32>; 2],
    apart: Vector3<I::F32>,
) -> I::F32 {
    let [a_x, a_y, a_z] = a.columns;
    let [b_x, b_y, b_z] = b.columns;
    // Cosines of the angles between the axes of both.
    let (xx, xy, xz) = (a_x.dot(b_x).abs(), a_x.dot(b_y).abs(), a_x.dot(b_z).abs());
    let (yx, yy, yz) = (a_y.dot(b_x).abs(), a_y.dot(b_y).abs(), a_y.dot(b_z).abs());
    let (zx, zy, zz) = (a_z.dot(b_x).abs(), a_z.dot(b_y).abs(), a_z.dot(b_z).abs());
    let [h_x, h_y, h_z] = splat::<I>(isa, half_b);
    let along_a = [
        xx.mul_add(h_x, xy.mul_add(h_y, xz * h_z)),
        yx.mul_add(h_x, yy.mul_add(h_y, yz * h_z)),
        zx.mul_add(h_x, zy.mul_add(h_y, zz * h_z)),
    ];
    let [h_x, h_y, h_z] = splat::<I>(isa, half_a);
    let along_b = [
        xx.mul_add(h_x, yx.mul_add(h_y, zx * h_z)),
        xy.mul_add(h_x, yy.mul_add(h_y, zy * h_z)),
        xz.mul_add(h_x, yz.mul_add(h_y, zz * h_z)),
    ];
    let beside_a = outside_box(isa, half_a, along_a, a.turn_back(apart));
    beside_a.max(outside_box(isa, half_b, along_b, b.turn_back(apart)))
}

#[inline(always)]
fn splat<I: Isa>(isa: I, [x, y, z]: [f32; 3]) -> [I::F32; 3] {
    [I::F32::splat(isa, x), I::F32::splat(isa, y), I::F32::splat(isa, z)]
}

/// How far outside of a box something begins that reaches so far along each of its axes about `at`, in the box's frame.
#[inline(always)]
fn outside_box<I: Isa>(isa: I, half: [f32; 3], reach: [I::F32; 3], at: Vector3<I::F32>) -> I::F32 {
    let zero = I::F32::constant(isa, 0.0);
    let gap_x = at.x.abs() - half[0] - reach[0];
    let gap_y = at.y.abs() - half[1] - reach[1];
    let gap_z = at.z.abs() - half[2] - reach[2];
    let most = gap_x.max(gap_y).max(gap_z);
    let (x, y, z) = (gap_x.max(zero), gap_y.max(zero), gap_z.max(zero));
    let outside = x.mul_add(x, y.mul_add(y, z * z)).sqrt();
    I::F32::select(zero.lt(most), outside, most)
}

/// How far a form reaches along a unit vector, from its centre.
#[inline(always)]
pub(crate) fn form_along<I: Isa>(isa: I, form: &Form, axes: &Rotation<I::F32>, n: Vector3<I::F32>) -> I::F32 {
    match *form {
        Form::Box(h) => {
            let [x, y, z] = axes.columns;
            (n.dot(x).abs() * h[0]) + (n.dot(y).abs() * h[1]) + (n.dot(z).abs() * h[2])
        }
        Form::Capsule { radius, half_length } => n.dot(axes.columns[2]).abs() * half_length + radius,
        Form::Cylinder { radius, half_length } => {
            let along = n.dot(axes.columns[2]);
            let across = along.neg_mul_add(along, I::F32::constant(isa, 1.0)).max(I::F32::constant(isa, 0.0));
            along.abs() * half_length + across.sqrt() * radius
        }
    }
}

/// How far a solid reaches along a unit vector, from its centre: the lesser of what its form and its capsule say.
#[inline(always)]
pub(crate) fn reach_along<I: Isa>(
    isa: I,
    bounding: &BoundingVolume,
    axes: &Rotation<I::F32>,
    n: Vector3<I::F32>,
) -> I::F32 {
    let form = form_along(isa, &bounding.form, axes, n);
    if !bounding.is_long {
        return form;
    }
    form.min(n.dot(axes.columns[bounding.along]).abs() * bounding.half_length + bounding.radius)
}

/// A unit vector along which the solids' axes are (nearly) farthest apart, from the second to the first.
#[inline(always)]
pub(crate) fn between_axes<I: Isa>(
    isa: I,
    bounding: [&BoundingVolume; 2],
    a: &Rotation<I::F32>,
    b: &Rotation<I::F32>,
    r: Vector3<I::F32>,
) -> Vector3<I::F32> {
    let (ha, hb) = (bounding[0].half_length, bounding[1].half_length);
    let u = a.columns[bounding[0].along].scaled(I::F32::splat(isa, ha));
    let v = b.columns[bounding[1].along].scaled(I::F32::splat(isa, hb));
    let (s, t) = nearest::<I>(isa, [(u, ha), (v, hb)], r);
    let w = v.scaled_from(t, u.scaled_plus(s, r));
    let length = w.dot(w).max(I::F32::splat(isa, 1e-20)).sqrt();
    // A little shorter than one, so that rounding makes no gap.
    w.scaled(I::F32::splat(isa, 1.0 - 4.0 * f32::EPSILON) / length)
}

/// Where the axes ± u and ± v, of half these lengths, are (nearly) closest, as shares of u and v; `r` is from the middle of the
/// second to that of the first.
#[inline(always)]
fn nearest<I: Isa>(isa: I, [(u, ha), (v, hb)]: [(Vector3<I::F32>, f32); 2], r: Vector3<I::F32>) -> (I::F32, I::F32) {
    let (uu, vv) = (I::F32::splat(isa, (ha * ha).max(1e-12)), I::F32::splat(isa, (hb * hb).max(1e-12)));
    let (uv, ur, vr) = (u.dot(v), u.dot(r), v.dot(r));
    let (one, back) = (I::F32::splat(isa, 1.0), I::F32::splat(isa, -1.0));
    let determinant = uv.neg_mul_add(uv, uu * vv).max(uu * vv * 1e-5);
    let s = ((uv * vr - vv * ur) / determinant).max(back).min(one);
    let t = (uv.mul_add(s, vr) / vv).max(back).min(one);
    let s = (uv.mul_sub(t, ur) / uu).max(back).min(one);
    (s, t)
}

/// Minus how far two solids overlap at least; positive where what lies inside of them does not say.
#[inline(always)]
pub(crate) fn overlap<I: Isa>(
    isa: I,
    bounding: [&BoundingVolume; 2],
    inscribed: [&InscribedVolume; 2],
    rows: [&[F32Row; POSE]; 2],
) -> I::F32 {
    let (a, b) = (Rotation::<I::F32>::load(isa, &rows[0][3..]), Rotation::load(isa, &rows[1][3..]));
    let apart = Vector3::<I::F32>::load(isa, &rows[0][..3]).minus(Vector3::load(isa, &rows[1][..3]));
    let (from_a, from_b) = (off_center::<I>(isa, inscribed[0], &a), off_center::<I>(isa, inscribed[1], &b));
    let r = apart.plus(from_a).minus(from_b);
    let (ha, hb) = (inscribed[0].half_length, inscribed[1].half_length);
    let u = a.columns[inscribed[0].along].scaled(I::F32::splat(isa, ha));
    let v = b.columns[inscribed[1].along].scaled(I::F32::splat(isa, hb));
    let (s, t) = nearest::<I>(isa, [(u, ha), (v, hb)], r);
    // Of the point on either axis: where it is, from the centre of the other's bounding volume.
    let p = u.scaled_plus(s, apart.plus(from_a));
    let q = v.scaled_plus(t, from_b.minus(apart));
    let between = p.minus(v.scaled_plus(t, from_b));
    let radii = I::F32::splat(isa, inscribed[0].radius + inscribed[1].radius);
    let mut least = between.dot(between).sqrt() - radii;
    if inscribed[0].fills {
        let beyond = outside::<I>(isa, &bounding[0].form, a.turn_back(q));
        least = least.min(beyond - I::F32::splat(isa, inscribed[1].radius));
    }
    if inscribed[1].fills {
        let beyond = outside::<I>(isa, &bounding[1].form, b.turn_back(p));
        least = least.min(beyond - I::F32::splat(isa, inscribed[0].radius));
    }
    least
}

/// From the centre of the bounding volume to that of the inscribed one, in the world.
#[inline(always)]
fn off_center<I: Isa>(isa: I, inscribed: &InscribedVolume, axes: &Rotation<I::F32>) -> Vector3<I::F32> {
    let [x, y, z] = inscribed.middle;
    axes.turn(Vector3::new(I::F32::splat(isa, x), I::F32::splat(isa, y), I::F32::splat(isa, z)))
}

/// How far a point, in its frame, is from a form; 0 inside.
#[inline(always)]
fn outside<I: Isa>(isa: I, form: &Form, p: Vector3<I::F32>) -> I::F32 {
    let zero = I::F32::constant(isa, 0.0);
    match *form {
        Form::Box(half) => {
            let (x, y, z) = (p.x.abs() - half[0], p.y.abs() - half[1], p.z.abs() - half[2]);
            let (x, y, z) = (x.max(zero), y.max(zero), z.max(zero));
            x.mul_add(x, y.mul_add(y, z * z)).sqrt()
        }
        Form::Cylinder { radius, half_length } => {
            let across = (p.x.mul_add(p.x, p.y * p.y).sqrt() - radius).max(zero);
            let along = (p.z.abs() - half_length).max(zero);
            across.mul_add(across, along * along).sqrt()
        }
        Form::Capsule { radius, half_length } => {
            let along = (p.z.abs() - half_length).max(zero);
            let from_axis = p.x.mul_add(p.x, p.y.mul_add(p.y, along * along)).sqrt();
            (from_axis - radius).max(zero)
        }
    }
}
