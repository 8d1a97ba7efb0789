//! A spline through dense knots, of a motion that follows a manifold.

use crate::trajectory::blend::BlendError;
use crate::trajectory::metric::time_at_full_speed;
use crate::trajectory::spline::Spline;

/// Buffers of [`spline_through`]. What they hold changes no answer.
#[derive(Clone, Debug, Default)]
pub struct ThroughScratch {
    widths: Vec<f64>,
    factors: Vec<f64>,
    row: Vec<f64>,
}

/// Writes the cubic spline with continuous second derivative through knots (`knots` lie one after the other, one number per
/// coordinate each), "not a knot" at both ends: the first two pieces are one cubic polynomial, and so are the last two. The parameter is
/// the length of [`time_at_full_speed`] along the polyline, from 0. Where the knots lie on a smooth curve at distances h, the spline
/// differs from it by O(h⁴). Two knots give a straight line, three a parabola.
///
/// Knots whose distance is not large beside their errors should be left out before: their directions are noise.
///
/// Source: C. de Boor, *A Practical Guide to Splines*, chapter IV.
///
/// # Errors
/// [`BlendError::Lengths`], [`BlendError::NotFinite`], or [`BlendError::NoLength`] where two consecutive knots differ in no
/// coordinate with a velocity limit.
pub fn spline_through(
    knots: &[f64],
    velocity: &[f64],
    scratch: &mut ThroughScratch,
    out: &mut Spline,
) -> Result<(), BlendError> {
    let size = velocity.len();
    out.clear(size);
    if size == 0 || !knots.len().is_multiple_of(size) || knots.len() < 2 * size {
        return Err(BlendError::Lengths);
    }
    let count = knots.len() / size;
    let knot = |k: usize| &knots[k * size..][..size];
    let widths = &mut scratch.widths;
    widths.clear();
    for k in 0..count {
        if knot(k).iter().any(|x| !x.is_finite()) {
            return Err(BlendError::NotFinite { knot: k });
        }
        if k + 1 < count {
            let width = time_at_full_speed(knot(k), knot(k + 1), velocity);
            if !(width > 0.0 && width.is_finite()) {
                return Err(BlendError::NoLength { knot: k });
            }
            widths.push(width);
        }
    }
    let mut parameter = 0.0;
    for k in 0..count {
        out.push_with(parameter, |i| (knot(k)[i], 0.0));
        parameter += widths.get(k).copied().unwrap_or(0.0);
    }
    for i in 0..size {
        let slope = |k: usize| (knots[(k + 1) * size + i] - knots[k * size + i]) / widths[k];
        derivatives(widths, slope, &mut scratch.factors, &mut scratch.row);
        for (k, derivative) in scratch.row.iter().enumerate() {
            out.velocity_mut(k)[i] = *derivative;
        }
    }
    Ok(())
}

/// Solves the tridiagonal system for the derivatives at the knots. Each inner row says that the second derivative is continuous, the
/// first and the last that the third is so at the next knot.
fn derivatives(h: &[f64], slope: impl Fn(usize) -> f64, factors: &mut Vec<f64>, row: &mut Vec<f64>) {
    let n = h.len();
    factors.clear();
    row.clear();
    if n == 1 {
        row.extend([slope(0); 2]);
        return;
    }
    if n == 2 {
        let (m0, m1, sum) = (slope(0), slope(1), h[0] + h[1]);
        let bend = (m1 - m0) / sum;
        row.extend([m0 - bend * h[0], m0 + bend * h[0], m1 + bend * h[1]]);
        return;
    }
    let sum = h[0] + h[1];
    let first = ((h[0] + 2.0 * sum) * h[1] * slope(0) + h[0] * h[0] * slope(1)) / sum;
    factors.push(sum / h[1]);
    row.push(first / h[1]);
    for k in 1..n {
        // h[k] d[k−1] + 2 (h[k−1] + h[k]) d[k] + h[k−1] d[k+1] = 3 (h[k] m[k−1] + h[k−1] m[k])
        let right = 3.0 * (h[k] * slope(k - 1) + h[k - 1] * slope(k));
        let pivot = 2.0 * (h[k - 1] + h[k]) - h[k] * factors[k - 1];
        row.push((right - h[k] * row[k - 1]) / pivot);
        factors.push(h[k - 1] / pivot);
    }
    let (a, b) = (h[n - 2], h[n - 1]);
    let sum = a + b;
    let right = (b * b * slope(n - 2) + (2.0 * sum + b) * a * slope(n - 1)) / sum;
    // sum d[n−1] + a d[n] = right
    row.push((right - sum * row[n - 1]) / (a - sum * factors[n - 1]));
    for k in (0..n).rev() {
        row[k] -= factors[k] * row[k + 1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The coordinate with the limit sets the parameter: it is the abscissa.
    fn through(abscissae: &[f64], ordinate: impl Fn(f64) -> f64) -> Spline {
        let knots: Vec<f64> = abscissae.iter().flat_map(|x| [*x, ordinate(*x)]).collect();
        let mut spline = Spline::new(0);
        spline_through(&knots, &[1.0, f64::INFINITY], &mut ThroughScratch::default(), &mut spline).unwrap();
        spline
    }

    #[test]
    fn polynomials_are_reproduced() {
        let abscissae = [0.0, 0.1, 0.4, 0.5, 0.9, 1.6];
        for count in 2..=6 {
            let degree = (count - 1).min(3);
            let polynomial = |x: f64| [1.0, -2.0, 3.0, -1.5][..=degree].iter().rev().fold(0.0, |sum, c| sum * x + c);
            let spline = through(&abscissae[..count], polynomial);
            let mut q = [0.0; 2];
            for k in 0..=50 {
                let x = spline.extent() * f64::from(k) / 50.0;
                spline.position(x, &mut q);
                assert!((q[1] - polynomial(x)).abs() < 1e-13, "{count} knots at {x}: {q:?}");
            }
        }
    }

    #[test]
    fn second_derivatives_are_continuous() {
        let spline = through(&[0.0, 0.1, 0.3, 0.5, 0.6, 0.65, 1.0], |x| (5.0 * x).sin());
        for k in 1..spline.pieces() {
            let [before, after] = [spline.cubic(k - 1, 1).accelerations()[1], spline.cubic(k, 1).accelerations()[0]];
            assert!((before - after).abs() < 1e-10, "{before} {after}");
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let made = |knots: &[f64]| {
            spline_through(knots, &[1.0, f64::INFINITY], &mut ThroughScratch::default(), &mut Spline::new(0))
        };
        assert_eq!(made(&[0.0, 0.0]), Err(BlendError::Lengths));
        assert_eq!(made(&[0.0, 0.0, 1.0]), Err(BlendError::Lengths));
        assert_eq!(made(&[0.0, 0.0, 0.0, 1.0]), Err(BlendError::NoLength { knot: 0 }));
        assert_eq!(made(&[0.0, 0.0, 1.0, f64::NAN]), Err(BlendError::NotFinite { knot: 1 }));
    }
}
