//! Polylines as splines: corners are replaced by symmetric quadratic arcs.
//!
//! The parameter is the length of [`time_at_full_speed`]: on a straight piece the derivative is the velocity at which the coordinate
//! that takes longest moves at its limit.

use crate::trajectory::metric::time_at_full_speed;
use crate::trajectory::spline::Spline;

/// Why a polyline does not become a spline.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlendError {
    /// Numbers do not make whole configurations, there are fewer than two of them, or there is not one radius for each.
    #[error("the polyline needs at least two knots, one number per coordinate and one radius per knot")]
    Lengths,
    /// A number is infinite or not a number, or a radius or a velocity limit is negative.
    #[error("knot {knot} of the polyline has a number that is not finite, or its radius is negative")]
    NotFinite {
        /// Which.
        knot: usize,
    },
    /// Two consecutive knots differ in no coordinate with a velocity limit, or in one whose limit is 0.
    #[error("knots {knot} and {} of the polyline have no length between them", knot + 1)]
    NoLength {
        /// The first of the two.
        knot: usize,
    },
    /// Arcs overlap: an edge is shorter than the radii at its ends.
    #[error("the blends at both ends of edge {edge} are longer than the edge: {radii} s on {length} s")]
    Overlap {
        /// The edge from knot `edge` to the next.
        edge: usize,
        /// The sum of both radii.
        radii: f64,
        /// Its length.
        length: f64,
    },
    /// A corner has radius 0: a motion stops there, so that the path must be cut there.
    #[error("knot {knot} of the polyline is a corner without a blend")]
    Corner {
        /// Which.
        knot: usize,
    },
}

/// Relative difference of the directions of two edges up to which they are one straight line.
const STRAIGHT: f64 = 1e-12;

/// Appends the arc that replaces a corner to a spline: its two knots. `out` may end with the arc's first knot, which is then
/// not written again.
///
/// With the directions d₀ = (q₁ − q₀)/L₀ and d₁ = (q₂ − q₁)/L₁ and lengths L by [`time_at_full_speed`], the arc leaves the first edge
/// at q₁ − r d₀ and joins the second at q₁ + r d₁. Between them its derivative goes linearly from d₀ to d₁ over the length 2 r, which is
/// the quadratic Bézier curve with control point q₁, and so a cubic Hermite piece. Its distance from the corner is
/// r |d₁ − d₀| / 4. It lies in the triangle of the corner.
///
/// # Errors
/// An edge has no length ([`BlendError::NoLength`]) or is shorter than `radius` ([`BlendError::Overlap`]).
pub fn blend_corner(corner: [&[f64]; 3], radius: f64, velocity: &[f64], out: &mut Spline) -> Result<(), BlendError> {
    let [q0, q1, q2] = corner;
    let lengths = [time_at_full_speed(q0, q1, velocity), time_at_full_speed(q1, q2, velocity)];
    for (edge, length) in lengths.into_iter().enumerate() {
        if !(length > 0.0 && length.is_finite()) {
            return Err(BlendError::NoLength { knot: edge });
        }
        if radius.is_nan() || radius < 0.0 || radius > length {
            return Err(BlendError::Overlap { edge, radii: radius, length });
        }
    }
    let start = out.parameters().last().copied().unwrap_or(0.0);
    for (end, ((from, to), length)) in [((q0, q1), lengths[0]), ((q1, q2), lengths[1])].into_iter().enumerate() {
        if end == 0 && !out.is_empty() {
            continue;
        }
        let towards = if end == 0 { -radius } else { radius };
        let parameter = if end == 0 { start } else { start + 2.0 * radius };
        push(out, parameter, (q1, towards), (from, to, length));
    }
    Ok(())
}

/// Pushes the point that lies `by` seconds behind a knot on an edge, with the edge's direction.
fn push(out: &mut Spline, parameter: f64, (knot, by): (&[f64], f64), (from, to, length): (&[f64], &[f64], f64)) {
    let at = |i: usize| {
        let direction = (to[i] - from[i]) / length;
        (knot[i] + by * direction, direction)
    };
    out.push_with(parameter, at);
}

/// Writes the spline of a polyline (`knots` lie one after the other, `size` numbers each) whose corners are replaced by arcs.
/// `radii` has the length of the arc on each side by knot; the first and the last are not used. Knots in the course of a straight
/// line may have radius 0 and then stay knots. The spline begins at parameter 0.
///
/// # Errors
/// What is written about [`BlendError`].
pub fn blend_polyline(knots: &[f64], radii: &[f64], velocity: &[f64], out: &mut Spline) -> Result<(), BlendError> {
    let size = velocity.len();
    out.clear(size);
    let count = radii.len();
    if count < 2 || size == 0 || knots.len() != count * size {
        return Err(BlendError::Lengths);
    }
    let knot = |k: usize| &knots[k * size..][..size];
    let no_limit = |limit: &f64| limit.is_nan() || *limit < 0.0;
    for (k, radius) in radii.iter().enumerate() {
        if knot(k).iter().any(|x| !x.is_finite()) || no_limit(radius) || velocity.iter().any(no_limit) {
            return Err(BlendError::NotFinite { knot: k });
        }
    }
    let radius = |k: usize| if k == 0 || k + 1 == count { 0.0 } else { radii[k] };
    let mut parameter = 0.0;
    for edge in 0..count - 1 {
        let (from, to) = (knot(edge), knot(edge + 1));
        let length = time_at_full_speed(from, to, velocity);
        if !(length > 0.0 && length.is_finite()) {
            return Err(BlendError::NoLength { knot: edge });
        }
        let (before, after) = (radius(edge), radius(edge + 1));
        let straight = length - before - after;
        if straight < -1e-12 * length {
            return Err(BlendError::Overlap { edge, radii: before + after, length });
        }
        let line = (from, to, length);
        if edge == 0 {
            push(out, parameter, (from, 0.0), line);
        } else if before > 0.0 {
            parameter += 2.0 * before;
            push(out, parameter, (from, before), line);
        } else if !goes_straight_on(out, line) {
            return Err(BlendError::Corner { knot: edge });
        }
        // Where two arcs meet, the end of the first is the start of the second.
        if straight > 1e-12 * length {
            parameter += straight;
            push(out, parameter, (to, -after), line);
        }
    }
    Ok(())
}

/// Whether an edge has the direction with which the spline ends.
fn goes_straight_on(out: &Spline, (from, to, length): (&[f64], &[f64], f64)) -> bool {
    let end = out.velocity(out.len() - 1);
    let largest = end.iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    end.iter().enumerate().all(|(i, v)| ((to[i] - from[i]) / length - v).abs() <= STRAIGHT * largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VELOCITY: [f64; 3] = [2.0, 1.0, f64::INFINITY];

    #[test]
    fn an_arc_is_a_quadratic_curve_that_is_tangent_to_both_edges() {
        let corner = [[0.0, 0.0, 1.0], [2.0, 0.5, 1.0], [2.0, 2.5, 3.0]];
        let mut arc = Spline::new(3);
        blend_corner(corner.each_ref().map(<[f64; 3]>::as_slice), 0.4, &VELOCITY, &mut arc).unwrap();
        assert_eq!((arc.len(), arc.extent()), (2, 0.8));
        assert_eq!((arc.velocity(0), arc.velocity(1)), ([2.0, 0.5, 0.0].as_slice(), [0.0, 1.0, 1.0].as_slice()));
        assert_eq!(arc.knot(0), [1.2, 0.3, 1.0]);
        let mut middle = [0.0; 3];
        arc.position(0.4, &mut middle);
        for i in 0..3 {
            let bezier = 0.25 * arc.knot(0)[i] + 0.5 * corner[1][i] + 0.25 * arc.knot(1)[i];
            assert!((middle[i] - bezier).abs() < 1e-15);
            let [a0, a1] = arc.cubic(0, i).accelerations();
            assert!((a0 - a1).abs() < 1e-12);
        }
    }

    #[test]
    fn a_polyline_is_followed() {
        let knots = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0, 4.0, 1.0, 0.0, 2.0, 1.0, 0.0];
        let mut path = Spline::new(0);
        blend_polyline(&knots, &[0.0, 0.0, 0.5, 0.5, 0.0], &VELOCITY, &mut path).unwrap();
        path.check().unwrap();
        // Two straight pieces, the arc, no straight piece between the arcs, the arc, a straight piece.
        assert_eq!(path.len(), 6);
        assert_eq!(path.extent(), 4.0);
        assert_eq!(path.knot(5), [2.0, 1.0, 0.0]);
        let refused = |radii: &[f64]| blend_polyline(&knots, radii, &VELOCITY, &mut Spline::new(0)).unwrap_err();
        assert_eq!(refused(&[0.0, 0.0, 0.0, 0.1, 0.0]), BlendError::Corner { knot: 2 });
        assert_eq!(refused(&[0.0, 0.0, 0.7, 0.5, 0.0]), BlendError::Overlap { edge: 2, radii: 1.2, length: 1.0 });
        assert_eq!(refused(&[0.0, 0.0, f64::NAN, 0.5, 0.0]), BlendError::NotFinite { knot: 2 });
        assert_eq!(refused(&[0.0, 0.0, 0.7]), BlendError::Lengths);
        let still = blend_polyline(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &[0.0; 2], &VELOCITY, &mut path);
        assert_eq!(still, Err(BlendError::NoLength { knot: 0 }));
    }
}
