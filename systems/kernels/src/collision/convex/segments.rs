//! The shortest vector between two segments, in closed form.
//!
//! Capsules and bounding capsules use it instead of GJK (`distance/query.rs`, `solids/volumes.rs`).

use glam::DVec3;

/// The shortest vector from the second of two segments to the first, each given by its middle and half of its direction.
#[inline]
#[must_use]
pub(crate) fn between_segments(p: DVec3, u: DVec3, q: DVec3, v: DVec3) -> DVec3 {
    let r = p - q;
    let (uu, vv, uv, ur, vr) = (u.dot(u), v.dot(v), u.dot(v), u.dot(r), v.dot(r));
    let unit = |x: f64| x.clamp(-1.0, 1.0);
    let along = |numerator: f64, square: f64| if square > 0.0 { unit(numerator / square) } else { 0.0 };
    // Minimise |r + s·u − t·v|² over the square [−1, 1]²: the free minimum in s, then t for it, then s for that t. For
    // parallel segments the first choice is arbitrary and the next two still end in a minimum of a convex function only
    // if they clamp the right end, so both ends of s are tried there.
    let determinant = uu * vv - uv * uv;
    let value = |s: f64| {
        let t = along(uv * s + vr, vv);
        let s = along(uv * t - ur, uu);
        r + u * s - v * t
    };
    if determinant > 1e-12 * uu * vv {
        value(unit((uv * vr - vv * ur) / determinant))
    } else {
        let shorter = |a: DVec3, b: DVec3| if b.length_squared() < a.length_squared() { b } else { a };
        shorter(shorter(value(-1.0), value(1.0)), value(0.0))
    }
}
