//! The time-optimal parameterisation of a path.

use crate::trajectory::peak_rates::Limits;
use crate::trajectory::spline::Spline;
use crate::trajectory::time_optimal::correction::{measure, tighten};
use crate::trajectory::time_optimal::counted::Counted;
use crate::trajectory::time_optimal::curve::{TimedPath, stretch, write};
use crate::trajectory::time_optimal::error::TimingError;
use crate::trajectory::time_optimal::grid::Grid;
use crate::trajectory::time_optimal::layout::{Interval, lay};
use crate::trajectory::time_optimal::passes::Profile;
use crate::trajectory::time_optimal::settings::TimingSettings;

/// Buffers of [`time_optimal`]. What they hold changes no answer.
#[derive(Clone, Debug, Default)]
pub struct TimingScratch {
    counted: Counted,
    intervals: Vec<Interval>,
    grid: Grid,
    profile: Profile,
    excess: Vec<[f64; 3]>,
}

/// What [`time_optimal`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TimingReport {
    /// Seconds.
    pub duration: f64,
    /// How many intervals the grid had.
    pub intervals: usize,
    /// By which factor the whole curve was slowed down at the end; 1 if it was not.
    pub stretch: f64,
}

/// Seconds that a path takes at least: bounds velocities where limits do not.
const LEAST_DURATION: f64 = 1e-6;

/// Writes the curve over time that follows a path from rest to rest as fast as limits of velocity and acceleration allow.
///
/// The curve goes through the grid points with the path's tangents. Between them it is a cubic polynomial over time and may leave the path
/// by about q⁗ h⁴ / 384, where h is the time of a piece; straight pieces are followed exactly. A caller that needs the curve free of
/// collisions proves the curve. It keeps its limits over the continuum (see [`peak_rates`](crate::trajectory::peak_rates)), also when its times are
/// shifted by up to 100 s and rounded.
///
/// Knots of the path are grid points, except within straight runs. Coordinates without limits are evaluated at the grid points and do
/// not count otherwise: not for what is straight, and not for the time.
///
/// A path that does not move has one knot and takes no time.
///
/// # Errors
/// See [`TimingError`]. Then `out` holds no curve.
pub fn time_optimal(
    path: &Spline,
    limits: Limits<'_>,
    settings: TimingSettings,
    scratch: &mut TimingScratch,
    out: &mut TimedPath,
) -> Result<TimingReport, TimingError> {
    time_optimal_below(path, limits, None, settings, scratch, out)
}

/// The largest path velocity that something besides the coordinates allows, between two parameters of the path: above 0, infinite
/// where there is none.
pub type Ceiling<'a> = &'a dyn Fn([f64; 2]) -> f64;

/// As [`time_optimal`], with a ceiling of the path velocity. It holds at the grid points of each interval for which it is asked, and between
/// them as far as the path velocity is monotone there: who needs it proved measures the curve and slows it down.
///
/// # Errors
/// As [`time_optimal`].
pub fn time_optimal_below(
    path: &Spline,
    limits: Limits<'_>,
    ceiling: Option<Ceiling<'_>>,
    settings: TimingSettings,
    scratch: &mut TimingScratch,
    out: &mut TimedPath,
) -> Result<TimingReport, TimingError> {
    out.curve.clear(path.size());
    out.parameters.clear();
    path.check()?;
    if path.is_empty() {
        return Err(TimingError::Empty);
    }
    let TimingScratch { counted, intervals, grid, profile, excess } = scratch;
    counted.find(path, limits)?;
    lay(path, counted, settings, ceiling.is_some(), intervals)?;
    if intervals.is_empty() {
        out.curve.push_with(0.0, |i| (path.knot(0)[i], 0.0));
        out.parameters.push(path.parameters()[0]);
        return Ok(TimingReport { stretch: 1.0, ..TimingReport::default() });
    }
    grid.evaluate(path, counted, intervals, (path.extent() / LEAST_DURATION).powi(2));
    if let Some(ceiling) = ceiling {
        intervals.iter().enumerate().for_each(|(k, interval)| grid.lower(k, ceiling(interval.ends)));
    }
    profile.begin(grid);
    grid.linearise(counted, &[], &profile.slower);
    profile.solve(grid);
    for _ in 0..settings.rounds {
        if measure(counted, grid, profile, excess) <= 1.0 + settings.stretch {
            break;
        }
        tighten(excess, profile);
        grid.linearise(counted, &profile.squares, &profile.slower);
        profile.solve(grid);
    }
    write(path, intervals, grid, profile, out);
    let stretch = stretch(&mut out.curve, counted);
    if out.curve.check().is_err() {
        out.curve.clear(path.size());
        return Err(TimingError::Precision);
    }
    Ok(TimingReport { duration: out.curve.extent(), intervals: intervals.len(), stretch })
}
