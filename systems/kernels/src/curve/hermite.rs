//! A curve through configurations with given velocities at given times.
//!
//! Between two knots every coordinate is the cubic Hermite polynomial in time through both positions and both velocities. The
//! quaternion of a free-flyer is made of four such numbers, scaled to length 1.

use crate::curve::cubic::Cubic;
use crate::curve::turning::keeps_away_from_zero;
use foliate_components::robot::configuration::{ConfigurationSpace, Group};

/// Numbers beyond this are no coordinates: their squares and products have room in bounds.
const LARGEST: f64 = 1e12;

/// A curve, as slices that the caller owns: one row per knot, end to end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HermiteCurve<'a> {
    /// Whole configurations.
    pub knots: &'a [f64],
    /// Derivatives of the configurations' numbers by time: as many as there are in `knots`. Those of objects that follow a
    /// carrier have no meaning.
    pub velocities: &'a [f64],
    /// Seconds, one per knot.
    pub times: &'a [f64],
}

/// A coordinate that leaves its bounds on a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitExceeded {
    /// Number of the piece, from 0.
    pub piece: usize,
    /// Index of the number in a configuration.
    pub coordinate: usize,
    /// Its extreme value on the piece, radians or metres.
    pub value: f64,
}

impl HermiteCurve<'_> {
    /// Number of pieces.
    #[must_use]
    pub fn pieces(&self) -> usize {
        self.times.len().saturating_sub(1)
    }

    /// Whether it is a curve of configurations of `space`: rows fit, numbers are finite and at most 10¹², times never decrease, two knots of one
    /// time are the same, and no quaternion comes near zero.
    #[must_use]
    pub fn is_sound(&self, space: &ConfigurationSpace) -> bool {
        let size = space.size();
        let fits = self.knots.len() == size * self.times.len() && self.velocities.len() == self.knots.len();
        // Compared so that NaN is refused.
        let all_small = |numbers: &[f64]| numbers.iter().all(|x| x.abs() <= LARGEST);
        if !fits || size == 0 || ![self.knots, self.velocities, self.times].iter().all(|numbers| all_small(numbers)) {
            return false;
        }
        let flyers = || space.factors.iter().filter(|factor| factor.group == Group::FreeFlyer);
        (0..self.pieces()).all(|piece| {
            let row = |knot: usize| &self.knots[knot * size..][..size];
            let duration = self.times[piece + 1] - self.times[piece];
            let goes_on = duration > 0.0 || (duration == 0.0 && row(piece) == row(piece + 1));
            let turns = |first: usize| keeps_away_from_zero(&[3, 4, 5, 6].map(|i| self.cubic(size, piece, first + i)));
            goes_on && flyers().all(|factor| turns(factor.q))
        })
    }

    /// One coordinate of one piece, as a function of u ∈ [0, 1]; `size` is the length of a configuration.
    ///
    /// # Panics
    /// If there is no such piece or coordinate.
    #[must_use]
    #[inline]
    pub fn cubic(&self, size: usize, piece: usize, coordinate: usize) -> Cubic {
        let (from, to) = (piece * size + coordinate, (piece + 1) * size + coordinate);
        let duration = self.times[piece + 1] - self.times[piece];
        let end = |at: usize| (self.knots[at], self.velocities[at] * duration);
        Cubic::hermite(end(from), end(to))
    }

    /// The configuration at u ∈ [0, 1] of a piece. At 0 it is the knot bit for bit.
    ///
    /// # Panics
    /// If there is no such piece, or `out` is shorter than a configuration.
    pub fn at(&self, space: &ConfigurationSpace, piece: usize, u: f64, out: &mut [f64]) {
        let size = space.size();
        if u <= 0.0 {
            out[..size].copy_from_slice(&self.knots[piece * size..][..size]);
            return;
        }
        for (coordinate, x) in out[..size].iter_mut().enumerate() {
            *x = self.cubic(size, piece, coordinate).at(u);
        }
        normalise_quaternions(space, out);
    }

    /// The first coordinate that leaves the bounds of `space` by more than `tolerance` anywhere on the curve, among those that
    /// count. The extremes of cubics are closed forms: nothing between two knots is missed.
    ///
    /// # Panics
    /// If rows do not fit.
    #[must_use]
    pub fn first_out_of_bounds(
        &self,
        space: &ConfigurationSpace,
        tolerance: f64,
        counts: impl Fn(usize) -> bool,
    ) -> Option<LimitExceeded> {
        let size = space.size();
        (0..self.pieces()).find_map(|piece| {
            (0..size).filter(|&i| counts(i)).find_map(|coordinate| {
                let (least, most) = self.cubic(size, piece, coordinate).range();
                let (lower, upper) = (space.lower[coordinate] - tolerance, space.upper[coordinate] + tolerance);
                let exceeded = |value| Some(LimitExceeded { piece, coordinate, value });
                match (least >= lower, most <= upper) {
                    (true, true) => None,
                    (false, _) => exceeded(least),
                    (true, false) => exceeded(most),
                }
            })
        })
    }

    /// All polynomials: by piece and coordinate.
    pub(crate) fn write_cubics(&self, size: usize, out: &mut Vec<Cubic>) {
        out.clear();
        for piece in 0..self.pieces() {
            out.extend((0..size).map(|coordinate| self.cubic(size, piece, coordinate)));
        }
    }
}

/// Scales quaternions of free-flyers to length 1.
pub(crate) fn normalise_quaternions(space: &ConfigurationSpace, q: &mut [f64]) {
    for factor in space.factors.iter().filter(|factor| factor.group == Group::FreeFlyer) {
        let own = &mut q[factor.q + 3..factor.q + 7];
        let length = own.iter().map(|x| x * x).sum::<f64>().sqrt();
        own.iter_mut().for_each(|x| *x /= length);
    }
}
