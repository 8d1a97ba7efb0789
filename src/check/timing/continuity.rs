//! A timed path begins and ends at rest, its segments follow one another without a jump in time or velocity, and where it claims so
//! accelerations do not jump either.

use crate::check::motion::curve::Timed;
use crate::check::motion::segment::SegmentMotion;
use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::kind::Kind;
use crate::check::timing::rates::{Derivatives, allowed, limits_of};
use crate::path_file::document::PathFile;

/// Accelerations on both sides of a knot are one where they differ by no more than this share of their limit.
const AGREE: f64 = 2e-6;

/// What is known from the segments before.
#[derive(Default)]
pub(crate) struct Continuity {
    before: Option<Before>,
    /// By column: the acceleration at the end of the last piece, and what rounding can do to it.
    accelerations: Vec<(f64, f64)>,
}

/// The end of a segment.
struct Before {
    time: f64,
    velocities: Vec<f64>,
    counts: Vec<bool>,
}

impl Continuity {
    /// Adds a segment.
    pub(crate) fn add(&mut self, motion: &SegmentMotion<'_>, file: &PathFile, report: &mut CheckReport) {
        let Some(timed) = motion.timed else { return };
        let counts = motion.moves_as_written();
        self.time(motion, timed, report);
        carried(motion, timed, file, &counts, report);
        self.velocities(motion, timed, file, &counts, report);
        self.accelerations(motion, timed, file, &counts, report);
        let last = motion.last();
        self.before = Some(Before { time: timed.times[last], velocities: timed.velocities[last].clone(), counts });
    }

    /// The path starts at time 0, and each segment when the one before ends.
    fn time(&self, motion: &SegmentMotion<'_>, timed: Timed<'_>, report: &mut CheckReport) {
        let wanted = self.before.as_ref().map_or(0.0, |before| before.time);
        let begins = timed.times[0];
        if begins != wanted {
            let subject = if self.before.is_some() {
                "a segment does not start when the one before ends"
            } else {
                "the path does not start at 0"
            };
            report.violate(Place::at(motion.index, 0.0), Kind::Times, subject, begins, wanted);
        }
        for (knot, pair) in timed.times.windows(2).enumerate().filter(|(_, pair)| pair[0] == pair[1]) {
            let moves = [knot, knot + 1].iter().any(|&k| timed.velocities[k].iter().any(|v| *v != 0.0));
            if moves {
                let subject = "two knots have one time, and there is a velocity";
                report.violate(Place::at(motion.index, knot as f64), Kind::Times, subject, pair[1], None);
            }
        }
    }

    /// Velocities at the joint knot are equal, and zero at both ends of the path.
    fn velocities(
        &self,
        motion: &SegmentMotion<'_>,
        timed: Timed<'_>,
        file: &PathFile,
        counts: &[bool],
        report: &mut CheckReport,
    ) {
        let is_last = motion.index + 1 == file.segments.len();
        let last = motion.last();
        for (column, &is_counted) in counts.iter().enumerate() {
            let name = || shown(&file.coordinates[column]);
            let wanted = match &self.before {
                Some(before) if before.counts[column] && is_counted => before.velocities[column],
                // What begins to move or ends to move as written does so at rest.
                Some(before) if before.counts[column] => {
                    jump(motion, report, 0, name(), (before.velocities[column], 0.0));
                    continue;
                }
                _ => 0.0,
            };
            if is_counted {
                jump(motion, report, 0, name(), (timed.velocities[0][column], wanted));
            }
            if is_counted && is_last {
                jump(motion, report, last, name(), (timed.velocities[last][column], 0.0));
            }
        }
    }

    /// Where the file claims it, or a limit of the jerk needs it, accelerations agree at every knot; they are zero at both ends.
    fn accelerations(
        &mut self,
        motion: &SegmentMotion<'_>,
        timed: Timed<'_>,
        file: &PathFile,
        counts: &[bool],
        report: &mut CheckReport,
    ) {
        let is_claimed = file.certificate.continuity == Some(2);
        self.accelerations.resize(counts.len(), (0.0, 0.0));
        let is_last = motion.index + 1 == file.segments.len();
        for (column, before) in self.accelerations.iter_mut().enumerate() {
            let limits = limits_of(file, column);
            if !is_claimed && limits.jerk.is_none() {
                continue;
            }
            let kind = if limits.jerk.is_some() { Kind::JerkLimit } else { Kind::Certificate };
            let mut agree = |knot: usize, here: (f64, f64), before: (f64, f64)| {
                let limit = limits.acceleration.unwrap_or(1.0 + here.0.abs());
                let jump = (here.0 - before.0).abs();
                // Compared so that NaN is a jump.
                let is_one = jump <= allowed(limit, here.1 + before.1, AGREE) - limit;
                if !is_one {
                    let subject = format!("the acceleration of {} jumps", shown(&file.coordinates[column]));
                    report.violate(Place::at(motion.index, knot as f64), kind, subject, jump, AGREE * limit);
                }
            };
            if !counts[column] {
                agree(0, (0.0, 0.0), *before);
                *before = (0.0, 0.0);
                continue;
            }
            for knot in 0..motion.last() {
                let Some(derivatives) = Derivatives::of(motion, timed, column, knot) else { continue };
                let ([start, end], rounding) = (derivatives.ends(), derivatives.rounding_of_ends());
                agree(knot, (start, rounding), *before);
                *before = (end, rounding);
            }
            if is_last {
                agree(motion.last(), (0.0, 0.0), *before);
            }
        }
    }
}

fn jump(motion: &SegmentMotion<'_>, report: &mut CheckReport, knot: usize, name: String, (found, wanted): (f64, f64)) {
    if found != wanted {
        report.violate(Place::at(motion.index, knot as f64), Kind::VelocityJump, name, found, wanted);
    }
}

/// Velocities of objects that follow a carrier or rest have no meaning, and are written 0.
fn carried(motion: &SegmentMotion<'_>, timed: Timed<'_>, file: &PathFile, counts: &[bool], report: &mut CheckReport) {
    for (column, _) in counts.iter().enumerate().filter(|(_, counts)| !**counts) {
        let written = timed.velocities.iter().position(|row| row[column] != 0.0);
        if let Some(knot) = written {
            let (place, value) = (Place::at(motion.index, knot as f64), timed.velocities[knot][column]);
            report.violate(place, Kind::CarriedVelocity, shown(&file.coordinates[column]), value, 0.0);
        }
    }
}
