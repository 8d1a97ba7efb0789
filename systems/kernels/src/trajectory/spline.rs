//! A cubic Hermite spline through whole configurations.

use crate::trajectory::cubic::Cubic;

/// A curve through configurations. Between two knots every coordinate is the cubic Hermite polynomial through both positions and both
/// derivatives, so that the derivative is continuous. The parameter is a length along a path or a time.
///
/// Coordinates are numbers: those of a quaternion are interpolated like all others and are not of length 1 between the knots.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spline {
    pub(super) size: usize,
    pub(super) parameters: Vec<f64>,
    pub(super) knots: Vec<f64>,
    pub(super) velocities: Vec<f64>,
}

/// Why numbers are no [`Spline`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// There are not as many positions and derivatives as knots times coordinates.
    #[error("a spline needs one position and one derivative for each knot and coordinate")]
    Lengths,
    /// A number is infinite or not a number.
    #[error("knot {knot} of the spline has a number that is not finite")]
    NotFinite {
        /// Which.
        knot: usize,
    },
    /// Parameters do not increase.
    #[error("the parameter of knot {knot} is not greater than that of the knot before")]
    Order {
        /// Which.
        knot: usize,
    },
    /// A spline that is appended begins elsewhere.
    #[error("coordinate {coordinate} of the appended spline does not begin where this one ends")]
    Apart {
        /// Which.
        coordinate: usize,
    },
}

impl Spline {
    /// A spline without knots.
    #[must_use]
    pub fn new(size: usize) -> Self {
        Self { size, ..Self::default() }
    }

    /// A spline of `size` coordinates. `knots` and `velocities` (derivatives by the parameter) lie knot by knot.
    ///
    /// # Errors
    /// Lengths do not agree, a number is not finite, or parameters do not increase.
    pub fn from_parts(
        size: usize,
        parameters: Vec<f64>,
        knots: Vec<f64>,
        velocities: Vec<f64>,
    ) -> Result<Self, SplineError> {
        let spline = Self { size, parameters, knots, velocities };
        spline.check()?;
        Ok(spline)
    }

    /// Whether this is a spline: [`Self::push`] does not ask.
    ///
    /// # Errors
    /// Those of [`Self::from_parts`].
    pub fn check(&self) -> Result<(), SplineError> {
        let count = self.parameters.len() * self.size;
        if self.knots.len() != count || self.velocities.len() != count {
            return Err(SplineError::Lengths);
        }
        for knot in 0..self.len() {
            let numbers = self.knot(knot).iter().chain(self.velocity(knot));
            if !self.parameters[knot].is_finite() || numbers.into_iter().any(|x| !x.is_finite()) {
                return Err(SplineError::NotFinite { knot });
            }
            if knot > 0 && self.parameters[knot] <= self.parameters[knot - 1] {
                return Err(SplineError::Order { knot });
            }
        }
        Ok(())
    }

    /// How many coordinates a configuration has.
    #[must_use]
    pub fn size(&self) -> usize {
        self.size
    }

    /// How many knots there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.parameters.len()
    }

    /// Whether there are no knots.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parameters.is_empty()
    }

    /// How many pieces lie between the knots.
    #[must_use]
    pub fn pieces(&self) -> usize {
        self.len().saturating_sub(1)
    }

    /// Parameters of the knots.
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Length of the parameter interval: the duration of a curve over time. 0 without knots.
    #[must_use]
    pub fn extent(&self) -> f64 {
        match (self.parameters.first(), self.parameters.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Configuration at a knot.
    #[inline]
    #[must_use]
    pub fn knot(&self, knot: usize) -> &[f64] {
        &self.knots[knot * self.size..][..self.size]
    }

    /// Derivative by the parameter at a knot.
    #[inline]
    #[must_use]
    pub fn velocity(&self, knot: usize) -> &[f64] {
        &self.velocities[knot * self.size..][..self.size]
    }

    /// Configuration at a knot, to be changed: say, where objects are written that follow a carrier.
    #[must_use]
    pub fn knot_mut(&mut self, knot: usize) -> &mut [f64] {
        &mut self.knots[knot * self.size..][..self.size]
    }

    /// Derivative by the parameter at a knot, to be changed.
    #[must_use]
    pub fn velocity_mut(&mut self, knot: usize) -> &mut [f64] {
        &mut self.velocities[knot * self.size..][..self.size]
    }

    /// Length of the parameter interval of a piece.
    #[inline]
    #[must_use]
    pub fn width(&self, piece: usize) -> f64 {
        self.parameters[piece + 1] - self.parameters[piece]
    }

    /// One coordinate on one piece.
    #[inline]
    #[must_use]
    pub fn cubic(&self, piece: usize, coordinate: usize) -> Cubic {
        let (from, to) = (piece * self.size + coordinate, (piece + 1) * self.size + coordinate);
        Cubic {
            positions: [self.knots[from], self.knots[to]],
            velocities: [self.velocities[from], self.velocities[to]],
            width: self.width(piece),
        }
    }

    /// The piece on which a parameter lies, and where on it, from 0 to 1. A knot belongs to the piece that it begins. Parameters
    /// beyond an end mean that end.
    ///
    /// # Panics
    /// If there are fewer than two knots.
    #[must_use]
    pub fn locate(&self, parameter: f64) -> (usize, f64) {
        let inner = &self.parameters[1..self.len() - 1];
        let piece = inner.partition_point(|p| *p <= parameter);
        let u = (parameter - self.parameters[piece]) / self.width(piece);
        (piece, if u.is_nan() { 0.0 } else { u.clamp(0.0, 1.0) })
    }

    /// Writes the configuration at `u` in [0, 1] of a piece.
    pub fn position_on(&self, piece: usize, u: f64, out: &mut [f64]) {
        self.each(piece, out, |cubic| cubic.position(u));
    }

    /// Writes the derivative by the parameter at `u` in [0, 1] of a piece.
    pub fn velocity_on(&self, piece: usize, u: f64, out: &mut [f64]) {
        self.each(piece, out, |cubic| cubic.velocity(u));
    }

    /// Writes the second derivative by the parameter at `u` in [0, 1] of a piece. At knots it may jump.
    pub fn acceleration_on(&self, piece: usize, u: f64, out: &mut [f64]) {
        self.each(piece, out, |cubic| cubic.acceleration(u));
    }

    /// Writes the configuration at a parameter; beyond an end that of the end.
    ///
    /// # Panics
    /// If there are no knots.
    pub fn position(&self, parameter: f64, out: &mut [f64]) {
        if self.len() == 1 {
            return out.copy_from_slice(self.knot(0));
        }
        let (piece, u) = self.locate(parameter);
        self.position_on(piece, u, out);
    }

    /// Writes the derivative at a parameter; beyond an end that of the end.
    ///
    /// # Panics
    /// If there are no knots.
    pub fn derivative(&self, parameter: f64, out: &mut [f64]) {
        if self.len() == 1 {
            return out.copy_from_slice(self.velocity(0));
        }
        let (piece, u) = self.locate(parameter);
        self.velocity_on(piece, u, out);
    }

    /// Writes the second derivative at a parameter, at a knot that of the piece behind it; 0 where there is no piece.
    pub fn second_derivative(&self, parameter: f64, out: &mut [f64]) {
        if self.pieces() == 0 {
            return out.fill(0.0);
        }
        let (piece, u) = self.locate(parameter);
        self.acceleration_on(piece, u, out);
    }

    /// Least and greatest position of one coordinate on one piece; likewise `velocity_range` of [`Self::cubic`].
    #[must_use]
    pub fn position_range(&self, piece: usize, coordinate: usize) -> [f64; 2] {
        self.cubic(piece, coordinate).position_range()
    }

    fn each(&self, piece: usize, out: &mut [f64], value: impl Fn(Cubic) -> f64) {
        for (coordinate, out) in out.iter_mut().enumerate().take(self.size) {
            *out = value(self.cubic(piece, coordinate));
        }
    }

    /// Forgets the knots and keeps the memory.
    pub fn clear(&mut self, size: usize) {
        self.size = size;
        self.parameters.clear();
        self.knots.clear();
        self.velocities.clear();
    }

    /// Adds a knot at the end. The parameter must be greater than the last one.
    ///
    /// # Panics
    /// If a slice does not have one number per coordinate.
    pub fn push(&mut self, parameter: f64, knot: &[f64], velocity: &[f64]) {
        assert!(knot.len() == self.size && velocity.len() == self.size, "one number per coordinate");
        self.parameters.push(parameter);
        self.knots.extend_from_slice(knot);
        self.velocities.extend_from_slice(velocity);
    }

    /// Adds a knot at the end, of which `at` tells position and derivative by coordinate.
    pub fn push_with(&mut self, parameter: f64, at: impl Fn(usize) -> (f64, f64)) {
        self.parameters.push(parameter);
        for coordinate in 0..self.size {
            let (position, velocity) = at(coordinate);
            self.knots.push(position);
            self.velocities.push(velocity);
        }
    }

    /// Adds a knot at the end: the point at `u` in [0, 1] of another spline's piece, with its derivative times `rate`.
    pub fn push_point(&mut self, parameter: f64, of: &Self, (piece, u): (usize, f64), rate: f64) {
        self.parameters.push(parameter);
        for coordinate in 0..self.size {
            let cubic = of.cubic(piece, coordinate);
            self.knots.push(cubic.position(u));
            self.velocities.push(rate * cubic.velocity(u));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> Spline {
        Spline::from_parts(
            2,
            vec![1.0, 1.5, 3.0],
            vec![0.0, 1.0, 0.5, -1.0, 2.0, 0.25],
            vec![1.0, 0.0, 0.5, 0.75, -2.0, 0.0],
        )
        .unwrap()
    }

    #[test]
    fn beyond_an_end_lies_the_end() {
        let (curve, mut out) = (curve(), [0.0; 2]);
        curve.position(9.0, &mut out);
        assert_eq!(out, [2.0, 0.25]);
        curve.position(f64::NAN, &mut out);
        assert_eq!(out, [0.0, 1.0]);
        curve.derivative(-1.0, &mut out);
        assert_eq!(out, [1.0, 0.0]);
        curve.second_derivative(1.5, &mut out);
        assert_eq!(out, [curve.cubic(1, 0).accelerations()[0], curve.cubic(1, 1).accelerations()[0]]);
    }

    #[test]
    fn what_is_no_spline_is_refused() {
        let made = |parameters: &[f64], knots: &[f64], velocities: &[f64]| {
            Spline::from_parts(1, parameters.to_vec(), knots.to_vec(), velocities.to_vec()).unwrap_err()
        };
        assert_eq!(made(&[0.0, 1.0], &[0.0], &[0.0, 0.0]), SplineError::Lengths);
        assert_eq!(made(&[0.0, 0.0], &[0.0, 0.0], &[0.0, 0.0]), SplineError::Order { knot: 1 });
        assert_eq!(made(&[0.0, 1.0], &[0.0, f64::NAN], &[0.0, 0.0]), SplineError::NotFinite { knot: 1 });
        assert_eq!(made(&[0.0, 1.0], &[0.0, 0.0], &[f64::INFINITY, 0.0]), SplineError::NotFinite { knot: 0 });
    }
}
