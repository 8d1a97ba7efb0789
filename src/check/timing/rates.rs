//! Limits of velocity, acceleration and jerk. Between two knots all three are polynomials of the second degree or less, so their
//! extremes are known; nothing is sampled.

use crate::check::motion::curve::{Cubic, Timed};
use crate::check::motion::segment::SegmentMotion;
use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::kind::Kind;
use crate::check::world::models::{Value, World};
use crate::path_file::document::{PathFile, RateLimitEntry};
use foliate_components::robot::PartKind;

/// Rounding allowed beyond a limit, as a share of it.
const SLACK: f64 = 1e-9;
/// What the rounding of knots and times may do to a rate counts as well, up to this share of its limit.
const MOST_ROUNDING: f64 = 1e-6;

/// Derivatives of a coordinate between two knots, and how far rounding of what the file writes can change them.
pub(crate) struct Derivatives {
    duration: f64,
    cubic: Cubic,
    /// Of the mean velocity.
    rounding: f64,
    /// Of times, as a share of the duration.
    stretch: f64,
}

impl Derivatives {
    /// Of a column from a knot to the next; none where no time passes.
    pub(crate) fn of(motion: &SegmentMotion<'_>, timed: Timed<'_>, column: usize, knot: usize) -> Option<Self> {
        let [from, to] = [knot, knot + 1].map(|k| timed.times[k]);
        let duration = to - from;
        let (cubic, unit) = (motion.cubic(column, knot), f64::EPSILON);
        let stretch = unit * (from.abs() + to.abs()) / duration;
        let speeds = timed.velocities[knot][column].abs() + timed.velocities[knot + 1][column].abs();
        let positions = (cubic.start.abs() + cubic.end.abs()) / duration;
        let mean = (cubic.end - cubic.start).abs() / duration;
        (duration > 0.0).then_some(Self {
            duration,
            cubic,
            rounding: unit * (positions + speeds) + mean * stretch,
            stretch,
        })
    }

    fn velocity(&self) -> (f64, f64) {
        (self.cubic.fastest() / self.duration, 3.0 * self.rounding)
    }

    fn acceleration(&self) -> (f64, f64) {
        let value = self.cubic.most_bent() / self.duration.powi(2);
        (value, 6.0 * self.rounding / self.duration + value * self.stretch)
    }

    fn jerk(&self) -> (f64, f64) {
        let value = 6.0 * self.cubic.third.abs() / self.duration.powi(3);
        (value, 12.0 * self.rounding / self.duration.powi(2) + 2.0 * value * self.stretch)
    }

    /// Accelerations at both ends.
    pub(crate) fn ends(&self) -> [f64; 2] {
        self.cubic.bends().map(|bend| bend / self.duration.powi(2))
    }

    /// How far rounding can change an acceleration.
    pub(crate) fn rounding_of_ends(&self) -> f64 {
        self.acceleration().1
    }
}

/// What a rate may be: its limit, and what rounding can do.
pub(crate) fn allowed(limit: f64, rounding: f64, slack: f64) -> f64 {
    limit + slack * limit + rounding.min(MOST_ROUNDING * limit)
}

/// The limits of a column; without an entry there are none.
pub(crate) fn limits_of(file: &PathFile, column: usize) -> RateLimitEntry {
    let table = file.rate_limits.as_ref();
    table.and_then(|table| table.get(&file.coordinates[column])).copied().unwrap_or_default()
}

/// Proves the limits along a segment.
pub(crate) fn check(motion: &SegmentMotion<'_>, file: &PathFile, report: &mut CheckReport) {
    let Some(timed) = motion.timed else { return };
    if let (Some(first), Some(last)) = (timed.times.first(), timed.times.last()) {
        *report.duration.get_or_insert(0.0) += last - first;
    }
    for (column, _) in motion.moves_as_written().into_iter().enumerate().filter(|(_, counts)| *counts) {
        let limits = limits_of(file, column);
        for knot in 0..motion.last() {
            let Some(derivatives) = Derivatives::of(motion, timed, column, knot) else { continue };
            for (kind, limit, (value, rounding)) in [
                (Kind::VelocityLimit, limits.velocity, derivatives.velocity()),
                (Kind::AccelerationLimit, limits.acceleration, derivatives.acceleration()),
                (Kind::JerkLimit, limits.jerk, derivatives.jerk()),
            ] {
                let Some(limit) = limit else { continue };
                // Compared so that NaN is beyond.
                let within = value <= allowed(limit, rounding, SLACK);
                let name = || shown(&file.coordinates[column]);
                if !within {
                    report.violate(Place::at(motion.index, knot as f64), kind, name(), value, limit);
                }
                report.see_rate(kind, value / limit, motion.index, knot as f64, name);
            }
        }
    }
}

/// Where the file's limits are larger than the models', or missing: a scene may set them.
pub(crate) fn note_differences(file: &PathFile, world: &World, report: &mut CheckReport) {
    if file.rate_limits.is_none() {
        return;
    }
    for body in world.bodies.iter().filter(|body| world.parts[body.part].kind != PartKind::Environment) {
        let Value::Columns(columns) = &body.value else { continue };
        for &column in columns {
            let (name, said) = (shown(&file.coordinates[column]), limits_of(file, column));
            if said.velocity.is_none() || said.acceleration.is_none() {
                report.weaker(format!("{name} has no limit of its velocity or its acceleration"));
            }
            if let (Some(said), Some(limit)) = (said.velocity, body.velocity_limit)
                && said > limit * (1.0 + SLACK)
            {
                report.weaker(format!("the velocity limit of {name} is {said}, the model says {limit}"));
            }
        }
    }
}
