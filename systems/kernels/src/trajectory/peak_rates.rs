//! How much of its limits a curve over time uses, exactly.

use crate::trajectory::spline::Spline;
use foliate_components::problem::RateLimits;

/// Limits of velocity, acceleration and jerk by coordinate. An infinite limit is none; a coordinate without limits does not count.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// rad/s, m/s, or 1/s for the numbers of a quaternion.
    pub velocity: &'a [f64],
    /// The same per second.
    pub acceleration: &'a [f64],
    /// The same per second squared.
    pub jerk: &'a [f64],
}

impl<'a> From<&'a RateLimits> for Limits<'a> {
    fn from(limits: &'a RateLimits) -> Self {
        Self { velocity: &limits.velocity, acceleration: &limits.acceleration, jerk: &limits.jerk }
    }
}

/// The largest share of a limit that a curve uses, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Rate divided by limit; infinite where a number is not finite, or where a coordinate moves whose limit is 0.
    pub share: f64,
    /// The piece.
    pub piece: usize,
    /// The coordinate.
    pub coordinate: usize,
}

impl Peak {
    fn raise(&mut self, rate: f64, limit: f64, (piece, coordinate): (usize, usize)) {
        // A limit of 0 is kept by standing still.
        let share = if rate == 0.0 { 0.0 } else { rate / limit };
        if share <= self.share {
            return;
        }
        *self = Self { share: if share.is_nan() { f64::INFINITY } else { share }, piece, coordinate };
    }
}

/// The largest shares of limits that a curve over time uses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PeakRates {
    /// Of velocity.
    pub velocity: Peak,
    /// Of acceleration.
    pub acceleration: Peak,
    /// Of jerk, within the pieces. It bounds the jerk only where the acceleration is continuous: see [`acceleration_jump`].
    pub jerk: Peak,
}

impl PeakRates {
    /// Whether velocity and acceleration exceed no limit by more than a relative tolerance.
    #[must_use]
    pub fn keep_limits(&self, tolerance: f64) -> bool {
        self.velocity.share <= 1.0 + tolerance && self.acceleration.share <= 1.0 + tolerance
    }
}

/// The largest shares of limits that a curve over time uses. Each piece is a cubic polynomial: its velocity is extreme at its ends or
/// where its acceleration is 0, its acceleration is extreme at its ends, its jerk is constant. So these are extremes over the
/// continuum, not over samples.
///
/// # Panics
/// If there is not one limit for each coordinate.
#[must_use]
pub fn peak_rates(curve: &Spline, limits: Limits<'_>) -> PeakRates {
    let mut peaks = PeakRates::default();
    for piece in 0..curve.pieces() {
        for coordinate in 0..curve.size() {
            let (velocity, acceleration, jerk) =
                (limits.velocity[coordinate], limits.acceleration[coordinate], limits.jerk[coordinate]);
            if velocity == f64::INFINITY && acceleration == f64::INFINITY && jerk == f64::INFINITY {
                continue;
            }
            let (cubic, place) = (curve.cubic(piece, coordinate), (piece, coordinate));
            peaks.velocity.raise(cubic.top_velocity(), velocity, place);
            peaks.acceleration.raise(cubic.top_acceleration(), acceleration, place);
            peaks.jerk.raise(cubic.jerk().abs(), jerk, place);
        }
    }
    peaks
}

/// The largest change of acceleration at a knot, divided by the acceleration limit; the curve stands still before its first knot and
/// after its last one. The piece is the one that the knot begins.
///
/// # Panics
/// If there is not one limit for each coordinate.
#[must_use]
pub fn acceleration_jump(curve: &Spline, acceleration: &[f64]) -> Peak {
    let mut peak = Peak::default();
    for (coordinate, limit) in acceleration.iter().enumerate().take(curve.size()) {
        let mut before = 0.0;
        for piece in 0..curve.pieces() {
            let [start, end] = curve.cubic(piece, coordinate).accelerations();
            peak.raise((start - before).abs(), *limit, (piece, coordinate));
            before = end;
        }
        peak.raise(before.abs(), *limit, (curve.pieces(), coordinate));
    }
    peak
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_a_known_cubic() {
        // 3u² − 2u³ over 2 s and 1 rad: velocity 0.75 at half time, acceleration ±1.5 at the ends, jerk 1.5.
        let curve = Spline::from_parts(2, vec![0.0, 2.0], vec![0.0, 5.0, 1.0, 5.0], vec![0.0; 4]).unwrap();
        let limits = Limits { velocity: &[1.5, 0.0], acceleration: &[1.0, 0.0], jerk: &[f64::INFINITY, 0.0] };
        let peaks = peak_rates(&curve, limits);
        assert_eq!(peaks.velocity, Peak { share: 0.5, piece: 0, coordinate: 0 });
        assert_eq!(peaks.acceleration.share, 1.5);
        assert_eq!(peaks.jerk.share, 0.0);
        assert!(!peaks.keep_limits(0.4) && peaks.keep_limits(0.5));
        assert_eq!(acceleration_jump(&curve, limits.acceleration).share, 1.5);
    }

    #[test]
    fn what_moves_against_a_limit_of_zero_uses_infinitely_much() {
        let curve = Spline::from_parts(1, vec![0.0, 2.0], vec![0.0, 1.0], vec![0.0; 2]).unwrap();
        let peaks = peak_rates(&curve, Limits { velocity: &[0.0], acceleration: &[1.0], jerk: &[1.0] });
        assert_eq!(peaks.velocity.share, f64::INFINITY);
    }
}
