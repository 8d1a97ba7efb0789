//! Bounded jerk: a curve over time is averaged over a short window.
//!
//! The curve is sampled every d seconds, n = [`SAMPLES`] of these samples are averaged, and the averages are the control points of a
//! uniform cubic B-spline. That is a moving average over the window w = n d, of a curve that has been smoothed over d. Derivatives of a
//! B-spline lie between differences of its control points. Here these are averages of the curve's velocities and accelerations,
//! which cannot exceed what they average; and differences of two averaged accelerations w apart, divided by w, so that the jerk
//! is at most 2 a / w where the curve's acceleration is at most a.

use crate::trajectory::peak_rates::{Limits, peak_rates};
use crate::trajectory::spline::{Spline, SplineError};

/// How many samples are averaged. The more, the nearer the window comes to w alone, and the more knots there are.
const SAMPLES: usize = 4;
/// How often the window is halved in search of the shortest one.
const TRIES: usize = 6;
/// By how many seconds times may be shifted and rounded without exceeding limits.
const SHIFT: f64 = 100.0;

/// Buffers of [`limit_jerk`]. What they hold changes no answer.
#[derive(Clone, Debug, Default)]
pub struct JerkScratch {
    samples: Vec<f64>,
    controls: Vec<f64>,
}

/// What [`limit_jerk`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JerkReport {
    /// Over how many seconds the curve is averaged; 0 where nothing has a jerk limit, and the curve is unchanged.
    pub window: f64,
    /// How many seconds later than the given curve the new one passes the same place, in the middle between what its start and its
    /// end add.
    pub delay: f64,
    /// Seconds that the new curve takes.
    pub duration: f64,
}

/// Why a curve does not get bounded jerk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum JerkError {
    /// The curve is no spline.
    #[error(transparent)]
    Curve(#[from] SplineError),
    /// There is not one limit of each kind for each coordinate.
    #[error("there must be one limit of velocity, acceleration and jerk for each coordinate")]
    LimitCount,
    /// A limit is negative or not a number, or a coordinate moves whose jerk limit is 0.
    #[error("a limit of coordinate {coordinate} is negative, not a number, or 0 where the coordinate moves")]
    Limit {
        /// Which.
        coordinate: usize,
    },
    /// The curve does not begin and end at rest.
    #[error("coordinate {coordinate} is not at rest at both ends of the curve")]
    NotAtRest {
        /// Which.
        coordinate: usize,
    },
    /// Limits are so small or so large that times are no numbers.
    #[error("limits are too small or too large to compute times")]
    Precision,
}

/// Writes a curve over time with continuous acceleration whose jerk keeps its limits, beside a given one from rest to rest. It
/// starts and ends at the same places, at rest and without acceleration, and keeps the limits of velocity and acceleration that the
/// given one keeps. Its times begin at 0, its knots lie at equal distances of a quarter of the window.
///
/// It takes 1.25 windows longer, and leaves the place of the given curve by about 0.05 a w², where a is the acceleration there and w the
/// window; straight lines it does not leave. The window is at most twice the longest time in which an acceleration that the curve reaches
/// is built up at the jerk limit; shorter ones are tried. A caller that needs the curve free of collisions proves it again.
///
/// # Errors
/// See [`JerkError`]. Then `out` holds no curve.
pub fn limit_jerk(
    curve: &Spline,
    limits: Limits<'_>,
    scratch: &mut JerkScratch,
    out: &mut Spline,
) -> Result<JerkReport, JerkError> {
    out.clear(curve.size());
    curve.check()?;
    let widest = widest_window(curve, limits)?;
    if widest == 0.0 {
        out.append(curve, 0.0)?;
        return Ok(JerkReport { duration: curve.extent(), ..JerkReport::default() });
    }
    // The largest windows are sure to be wide enough; shorter ones are as good where the acceleration never changes so much.
    let (mut low, mut high) = (0.0, widest);
    for _ in 0..TRIES {
        let middle = 0.5 * (low + high);
        let step = scratch.average(curve, middle);
        if scratch.keeps_jerk(curve.size(), step, limits.jerk) {
            high = middle;
        } else {
            low = middle;
        }
    }
    let step = scratch.average(curve, high);
    scratch.write(curve.size(), step, out);
    settle(out, limits);
    if out.check().is_err() {
        out.clear(curve.size());
        return Err(JerkError::Precision);
    }
    let longer = out.extent() - curve.extent();
    Ok(JerkReport { window: step * SAMPLES as f64, delay: 0.5 * longer, duration: out.extent() })
}

/// A window that is wide enough.
fn widest_window(curve: &Spline, limits: Limits<'_>) -> Result<f64, JerkError> {
    let size = curve.size();
    if [limits.velocity, limits.acceleration, limits.jerk].iter().any(|limits| limits.len() != size) {
        return Err(JerkError::LimitCount);
    }
    let mut widest = 0.0_f64;
    for coordinate in 0..size {
        let own = [limits.velocity[coordinate], limits.acceleration[coordinate], limits.jerk[coordinate]];
        if own.iter().any(|limit| limit.is_nan() || *limit < 0.0) {
            return Err(JerkError::Limit { coordinate });
        }
        if own == [f64::INFINITY; 3] {
            continue;
        }
        let at_rest = |knot: usize| curve.velocity(knot)[coordinate] == 0.0;
        let moves_at_an_end = !curve.is_empty() && (!at_rest(0) || !at_rest(curve.len() - 1));
        if moves_at_an_end {
            return Err(JerkError::NotAtRest { coordinate });
        }
        let tops = (0..curve.pieces()).map(|piece| curve.cubic(piece, coordinate).top_acceleration());
        let top = tops.fold(0.0, f64::max);
        if top > 0.0 && own[2] == 0.0 {
            return Err(JerkError::Limit { coordinate });
        }
        if top > 0.0 {
            widest = widest.max(2.0 * top / own[2]);
        }
    }
    Ok(widest)
}

impl JerkScratch {
    /// Fills the control points for a window of at least this width; returns the distance of the samples.
    ///
    /// There are two more control points than knots, one before the first and one behind the last. The first three lie at the start,
    /// the last three at the end.
    fn average(&mut self, curve: &Spline, window: f64) -> f64 {
        let (size, extent) = (curve.size(), curve.extent());
        let (start, shortest) = (curve.parameters()[0], window / SAMPLES as f64);
        let count = (extent / shortest).floor().max(1.0);
        let step = shortest.max(extent / count);
        let count = count as usize;
        self.samples.clear();
        self.samples.resize((count + 1) * size, 0.0);
        for (k, row) in self.samples.chunks_exact_mut(size).enumerate() {
            if k == count {
                row.copy_from_slice(curve.knot(curve.len() - 1));
            } else {
                curve.position(start + step * k as f64, row);
            }
        }
        // Control point k averages the samples k − 2 − 3 … k − 2, those beyond an end being that end.
        let controls = count + SAMPLES + 4;
        self.controls.clear();
        for k in 0..controls {
            for i in 0..size {
                let sample = |back: usize| {
                    let at = (k as isize - 2 - back as isize).clamp(0, count as isize) as usize;
                    self.samples[at * size + i]
                };
                let first = sample(0);
                // Sums of differences: where all samples are the same, so is the average.
                let differences: f64 = (1..SAMPLES).map(|back| sample(back) - first).sum();
                self.controls.push(first + differences / SAMPLES as f64);
            }
        }
        step
    }

    fn keeps_jerk(&self, size: usize, step: f64, jerk: &[f64]) -> bool {
        let cube = step * step * step;
        let rows = self.controls.len() / size;
        (0..rows.saturating_sub(3)).all(|k| {
            let at = |row: usize, i: usize| self.controls[(k + row) * size + i];
            (0..size).all(|i| {
                let third = (at(3, i) - at(0, i)) - 3.0 * (at(2, i) - at(1, i));
                third.abs() <= jerk[i] * cube
            })
        })
    }

    fn write(&self, size: usize, step: f64, out: &mut Spline) {
        let rows = self.controls.len() / size;
        for k in 1..rows - 1 {
            let at = |row: usize, i: usize| self.controls[row * size + i];
            out.push_with((k - 1) as f64 * step, |i| {
                let (before, here, after) = (at(k - 1, i), at(k, i), at(k + 1, i));
                (here + ((before - here) + (after - here)) / 6.0, 0.5 * (after - before) / step)
            });
        }
    }
}

/// Slows the curve down by what rounding exceeds.
fn settle(curve: &mut Spline, limits: Limits<'_>) {
    let peaks = peak_rates(curve, limits);
    let rate = 1.0 / curve.width(0);
    let mut noise = [0.0_f64; 3];
    let time = f64::EPSILON * (SHIFT + curve.extent());
    for coordinate in 0..curve.size() {
        let largest = |of: fn(&Spline, usize) -> &[f64]| {
            (0..curve.len()).map(|k| of(curve, k)[coordinate].abs()).fold(0.0, f64::max)
        };
        let change = (2.0 * largest(Spline::knot) * f64::EPSILON + largest(Spline::velocity) * time) * rate;
        let own = [limits.velocity[coordinate], limits.acceleration[coordinate], limits.jerk[coordinate]];
        let grown = [change, 6.0 * change * rate, 12.0 * change * rate * rate];
        for ((noise, limit), grown) in noise.iter_mut().zip(own).zip(grown) {
            if grown > 0.0 {
                *noise = noise.max(grown / limit);
            }
        }
    }
    let [velocity, acceleration, jerk] = [peaks.velocity, peaks.acceleration, peaks.jerk].map(|peak| peak.share);
    let factor = (velocity + noise[0]).max((acceleration + noise[1]).sqrt()).max((jerk + noise[2]).cbrt());
    if factor > 1.0 && factor.is_finite() {
        curve.stretch(factor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: f64 = f64::INFINITY;

    fn curve() -> Spline {
        // One second of speeding up, one second of full speed, one of slowing down.
        Spline::from_parts(1, vec![0.0, 1.0, 2.0, 3.0], vec![0.0, 0.5, 1.5, 2.0], vec![0.0, 1.0, 1.0, 0.0]).unwrap()
    }

    fn limited(jerk: f64) -> (Spline, JerkReport) {
        let (velocity, acceleration, jerk) = ([1.0], [1.0], [jerk]);
        let limits = Limits { velocity: &velocity, acceleration: &acceleration, jerk: &jerk };
        let mut out = Spline::new(1);
        let report = limit_jerk(&curve(), limits, &mut JerkScratch::default(), &mut out).unwrap();
        (out, report)
    }

    #[test]
    fn a_trapezoid_gets_ramps_of_acceleration() {
        let (out, report) = limited(10.0);
        // The acceleration jumps by 1: at 10 per second that takes 0.1 s.
        assert!(report.window >= 0.09 && report.window < 0.13, "{report:?}");
        assert!((out.extent() - 3.0 - 1.25 * report.window).abs() < 1e-9, "{report:?}");
        assert_eq!((out.knot(0), out.knot(out.len() - 1)), ([0.0].as_slice(), [2.0].as_slice()));
        let peaks = peak_rates(&out, Limits { velocity: &[1.0], acceleration: &[1.0], jerk: &[10.0] });
        assert!(peaks.keep_limits(0.0) && peaks.jerk.share <= 1.0 && peaks.jerk.share > 0.7, "{peaks:?}");
    }

    #[test]
    fn without_a_jerk_limit_nothing_changes() {
        let (out, report) = limited(FREE);
        assert_eq!((out, report.window), (curve(), 0.0));
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let refused = |velocity: &[f64], jerk: &[f64], curve: &Spline| {
            let limits = Limits { velocity, acceleration: &[1.0], jerk };
            limit_jerk(curve, limits, &mut JerkScratch::default(), &mut Spline::new(1)).unwrap_err()
        };
        assert_eq!(refused(&[1.0], &[0.0], &curve()), JerkError::Limit { coordinate: 0 });
        assert_eq!(refused(&[1.0], &[f64::NAN], &curve()), JerkError::Limit { coordinate: 0 });
        assert_eq!(refused(&[1.0, 1.0], &[1.0], &curve()), JerkError::LimitCount);
        assert_eq!(refused(&[1.0], &[1.0], &curve().part(0.5, 3.0)), JerkError::NotAtRest { coordinate: 0 });
    }
}
