//! Errors of relative poses, bounded over the continuum.
//!
//! An error is the norm of a vector function of the place along the segment: masked rows of a position, a unit vector
//! less where it should be, a unit quaternion less its reference. Between two places it is at most the larger of both
//! values plus ⅛ sup‖f″‖ (the error of linear interpolation), and with S the sum of the travels of all joints between
//! the frames, ‖f″‖ ≤ c·S²: c is max(R, 1) for a position, R being longer than any distance from such a joint to the
//! point; 1 for a unit vector; ¼ for a quaternion, which turns at half the speed. Intervals are halved until the bound
//! decides.

use super::Work;
use super::motion::{At, SegmentMotion};
use super::report::{CheckReport, Kind, Place};
use foliate_components::Pose;
use glam::{DQuat, DVec3};

/// A vector whose norm is bounded, and what that norm means.
pub(super) enum Form {
    /// Distance from a point in the rows that count, in the axes of a frame. Metres.
    Rows { from: DVec3, rows: [bool; 3] },
    /// Angle between a direction of the frame and where it should be. Radians.
    Direction { local: DVec3, wanted: DVec3 },
    /// Angle of the rotation against a reference. Radians.
    Rotation { wanted: DQuat },
    /// |n · p − offset| of a point of the frame. Metres.
    Height { point: DVec3, normal: DVec3, offset: f64 },
    /// How far a point of the frame is beyond the worst of some planes (outward normal, offset). Metres.
    Outside { point: DVec3, planes: Vec<(DVec3, f64)> },
}

impl Form {
    /// Norm of the vector at a relative pose.
    fn norm(&self, pose: &Pose) -> f64 {
        match self {
            Self::Rows { from, rows } => {
                let error = pose.translation - *from;
                let counted = error.to_array().into_iter().zip(rows).filter(|(_, counts)| **counts);
                counted.map(|(e, _)| e * e).sum::<f64>().sqrt()
            }
            Self::Direction { local, wanted } => (pose.rotation * *local - *wanted).length(),
            Self::Rotation { wanted } => (pose.rotation - *wanted).length().min((pose.rotation + *wanted).length()),
            Self::Height { point, normal, offset } => (normal.dot(pose.transform_point(*point)) - offset).abs(),
            Self::Outside { point, planes } => {
                let at = pose.transform_point(*point);
                planes.iter().map(|(n, d)| n.dot(at) - d).fold(0.0, f64::max)
            }
        }
    }

    /// The error that a norm means: angles are longer than their chords.
    fn error(&self, norm: f64) -> f64 {
        let chord = |length: f64| 2.0 * (length / 2.0).min(1.0).asin();
        match self {
            Self::Direction { .. } => chord(norm),
            Self::Rotation { .. } => 2.0 * chord(norm),
            Self::Rows { .. } | Self::Height { .. } | Self::Outside { .. } => norm,
        }
    }

    /// The error at a relative pose.
    pub(super) fn error_at(&self, pose: &Pose) -> f64 {
        self.error(self.norm(pose))
    }

    /// c in ‖f″‖ ≤ c·S²; `length` is the way between the frames, and the point's distance from the frame is added.
    fn curvature(&self, length: f64) -> f64 {
        match self {
            Self::Rows { .. } => length.max(1.0),
            Self::Height { point, .. } | Self::Outside { point, .. } => (length + point.length()).max(1.0),
            Self::Direction { .. } => 1.0,
            Self::Rotation { .. } => 0.25,
        }
    }
}

/// A relation to be proved along a segment.
pub(super) struct Relation<'r> {
    pub kind: Kind,
    pub subject: &'r str,
    pub tolerance: f64,
    /// Errors with their names.
    pub forms: Vec<(&'static str, Form)>,
}

/// The relative pose along a segment, and how fast it changes.
pub(super) struct Relative<'r> {
    pub pose: &'r dyn Fn(At) -> Pose,
    /// Sum of the travels between the frames, from the first knot to each knot.
    pub travel: Vec<f64>,
    /// Length of the way between the frames, metres.
    pub length: f64,
}

/// Intervals over which more than this is travelled are halved whatever the bound says: the quaternion's sign is
/// followed by nearness, radians and metres.
const LONGEST: f64 = 0.5;
/// An interval whose bound adds less than this share of the tolerance is not halved further.
const FINEST: f64 = 1e-6;

/// Proves a relation over the whole segment, or reports where it does not hold.
pub(super) fn prove(
    motion: &SegmentMotion<'_>,
    relative: &Relative<'_>,
    relation: &Relation<'_>,
    report: &mut CheckReport,
    work: &mut Work,
) {
    for (what, form) in &relation.forms {
        let mut prover = Prover { motion, relative, relation, what, form, report, work };
        let mut before = prover.sample(At::knot(0));
        for knot in 0..motion.last() {
            let after = prover.sample(At::knot(knot + 1));
            prover.interval(knot, before, after);
            before = after;
        }
    }
}

struct Prover<'p, 'r> {
    motion: &'p SegmentMotion<'p>,
    relative: &'p Relative<'r>,
    relation: &'p Relation<'r>,
    what: &'static str,
    form: &'p Form,
    report: &'p mut CheckReport,
    work: &'p mut Work,
}

impl Prover<'_, '_> {
    fn subject(&self) -> String {
        format!("{}: {}", self.relation.subject, self.what)
    }

    /// The norm at a place; reports an error that is too large.
    fn sample(&mut self, at: At) -> f64 {
        self.report.counts.residual_samples += 1;
        let norm = self.form.norm(&(self.relative.pose)(at));
        let error = self.form.error(norm);
        // Compared so that NaN is too large.
        let fine = error <= self.relation.tolerance;
        if !fine {
            self.violate(at.t(), error);
        }
        let subject = format_args!("{}: {}", self.relation.subject, self.what);
        self.report.see_residual(error, self.motion.index, at.t(), || subject.to_string());
        norm
    }

    fn violate(&mut self, t: f64, error: f64) {
        let place = Place::at(self.motion.index, t);
        self.report.violate(place, self.relation.kind, self.subject(), error, self.relation.tolerance);
    }

    fn interval(&mut self, knot: usize, before: f64, after: f64) {
        let travel = self.relative.travel[knot + 1] - self.relative.travel[knot];
        let curvature = self.form.curvature(self.relative.length);
        let mut stack = vec![(0.0, before, 1.0, after)];
        while let Some((low, at_low, high, at_high)) = stack.pop() {
            let travelled = travel * (high - low);
            let swell = curvature * travelled * travelled / 8.0;
            let largest = at_low.max(at_high);
            let bound = self.form.error(largest + swell);
            if travelled <= LONGEST && bound <= self.relation.tolerance {
                self.report.residual_bound = self.report.residual_bound.max(bound);
                continue;
            }
            // Written so that NaN is too large.
            let fine = self.form.error(largest) <= self.relation.tolerance;
            if !fine {
                return; // reported when it was sampled
            }
            if !self.work.spend(1) {
                let place = Place::at(self.motion.index, knot as f64 + low);
                self.report.violate(place, Kind::Undecided, "the work limit is reached", None, None);
                return;
            }
            if swell <= FINEST * self.relation.tolerance && travelled <= LONGEST {
                self.violate(knot as f64 + low, bound); // in doubt, broken
                return;
            }
            let middle = (low + high) / 2.0;
            let at_middle = self.sample(At { knot, fraction: middle });
            stack.push((middle, at_middle, high, at_high));
            stack.push((low, at_low, middle, at_middle));
        }
    }
}
