//! From squared path velocities to a curve over time.

use crate::trajectory::spline::Spline;
use crate::trajectory::time_optimal::counted::Counted;
use crate::trajectory::time_optimal::grid::Grid;
use crate::trajectory::time_optimal::layout::Interval;
use crate::trajectory::time_optimal::passes::Profile;
use crate::trajectory::time_optimal::straight::Straight;

/// A curve over time, and where its knots lie on the path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimedPath {
    /// Over time from 0; at rest at both ends.
    pub curve: Spline,
    /// The path parameter of each knot.
    pub parameters: Vec<f64>,
}

/// Writes curves.
pub(super) struct Writer<'a> {
    pub path: &'a Spline,
    pub out: &'a mut TimedPath,
    pub now: f64,
    pub shortest: f64,
}

impl Writer<'_> {
    /// Writes the point at a path parameter that lies on a piece, passed with a path velocity.
    pub fn point(&mut self, piece: usize, parameter: f64, rate: f64) {
        let u = ((parameter - self.path.parameters()[piece]) / self.path.width(piece)).clamp(0.0, 1.0);
        self.out.curve.push_point(self.now, self.path, (piece, u), rate);
        self.out.parameters.push(parameter);
    }

    /// Writes a curved interval without its start.
    pub fn curved(&mut self, interval: &Interval, squares: [f64; 2], slower: f64) {
        let [c, d] = squares.map(f64::sqrt);
        self.now += 2.0 * slower * interval.width() / (c + d);
        self.point(interval.piece, interval.ends[1], d);
    }

    /// Writes a straight interval without its start: up to three phases of constant acceleration.
    pub fn straight(&mut self, interval: &Interval, straight: &Straight) {
        let [from, to] = interval.ends;
        let (mut at, mut square) = (from, straight.ends[0]);
        let [first, last, highest] = straight.phases(self.shortest);
        for (parameter, next) in [(from + first, highest), (to - last, highest), (to, straight.ends[1])] {
            let width = parameter - at;
            // Where two phases meet there is one knot.
            if width <= 1e-12 * interval.width() {
                continue;
            }
            self.now += 2.0 * width / (square.sqrt() + next.sqrt());
            self.point(self.path.locate(parameter).0, parameter, next.sqrt());
            (at, square) = (parameter, next);
        }
    }
}

/// Writes the curve of a profile.
pub(super) fn write(path: &Spline, intervals: &[Interval], grid: &Grid, profile: &Profile, out: &mut TimedPath) {
    out.curve.clear(path.size());
    out.parameters.clear();
    let straight = |k: usize, most: f64| Straight {
        ends: [profile.squares[k], profile.squares[k + 1]],
        width: grid.widths[k],
        top: grid.top[k].min(grid.top[k + 1]),
        most,
    };
    let time = |k: usize| match grid.straight[k] {
        Some(most) => grid.widths[k] / straight(k, most).free().min(straight(k, most).top).sqrt(),
        None => 2.0 * grid.widths[k] / (profile.squares[k].sqrt() + profile.squares[k + 1].sqrt()),
    };
    let shortest = SHORTEST.min(SHORTEST_SHARE * (0..intervals.len()).map(time).sum::<f64>());
    let mut writer = Writer { path, out, now: 0.0, shortest };
    let Some(first) = intervals.first() else { return };
    writer.point(first.piece, first.ends[0], 0.0);
    for (k, interval) in intervals.iter().enumerate() {
        match grid.straight[k] {
            Some(most) => writer.straight(interval, &straight(k, most)),
            None => writer.curved(interval, [profile.squares[k], profile.squares[k + 1]], profile.slower[k]),
        }
    }
}

/// Seconds below which a phase of a straight interval is not worth two knots: rates of shorter pieces are uncertain by rounding.
const SHORTEST: f64 = 2e-3;
/// The same as a share of the time of the whole path, for paths that take very little.
const SHORTEST_SHARE: f64 = 0.01;

/// Slows the whole curve down until its exact rates keep their limits. Returns the factor.
///
/// What rounding may change is added to the rates: where the times are shifted by up to [`SHIFT`] and rounded, where this factor is
/// applied, and where an acceleration is computed in another way.
pub(super) fn stretch(curve: &mut Spline, counted: &Counted) -> f64 {
    let [mut velocity, mut acceleration] = [0.0_f64; 2];
    let time = f64::EPSILON * (SHIFT + curve.extent());
    for piece in 0..curve.pieces() {
        let rate = 1.0 / curve.width(piece);
        for (j, &coordinate) in counted.coordinates.iter().enumerate() {
            let cubic = curve.cubic(piece, coordinate);
            let ([q0, q1], [v0, v1]) = (cubic.positions, cubic.velocities);
            let mean = (q1 - q0) * rate;
            let (d0, d1) = (mean - v0, mean - v1);
            let (a0, a1) = (4.0 * d0 + 2.0 * d1, -(2.0 * d0 + 4.0 * d1));
            let mut top = v0.abs().max(v1.abs());
            if a0 * a1 < 0.0 {
                top = top.max((v0 + 0.5 * a0 * (a0 / (a0 - a1))).abs());
            }
            let rounding = (top * time + (q0.abs() + q1.abs()) * f64::EPSILON) * rate;
            velocity = velocity.max((top + rounding) * counted.by_velocity[j]);
            acceleration =
                acceleration.max((a0.abs().max(a1.abs()) + 6.0 * rounding) * rate * counted.by_acceleration[j]);
        }
    }
    let factor = velocity.max(acceleration.sqrt()) * (1.0 + 8.0 * f64::EPSILON);
    if factor > 1.0 && factor.is_finite() {
        curve.stretch(factor);
        return factor;
    }
    1.0
}

/// By how many seconds times may be shifted without exceeding limits.
const SHIFT: f64 = 100.0;
