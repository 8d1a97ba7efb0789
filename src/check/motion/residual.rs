//! Errors of relative poses, bounded over the continuum.
//!
//! An error is the norm of a vector function of the place along the segment: masked rows of a position, a unit vector
//! less where it should be, a unit quaternion less its reference. Between two places it is at most the larger of both
//! values plus ⅛ sup‖f″‖ (the error of linear interpolation); [`Bends`] bounds ‖f″‖, with q″ where coordinates are curves. Intervals are halved until the bound
//! decides. So a step from one solution branch of a closed chain to another is refused however well both knots fit: in
//! between the chain is open, and no bound says otherwise.

use crate::check::motion::reach::Bends;
use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::kind::Kind;
use crate::check::report::work::Work;
use foliate_components::Pose;
use glam::{DQuat, DVec3};

/// What is measured along a segment, and how far it can be off between two samples.
pub(crate) trait Quantity {
    /// What is kept of a place.
    type Sample: Copy;

    /// Measures at a place.
    fn sample(&self, at: At) -> Self::Sample;

    /// How far a sample is off, metres or radians.
    fn error(&self, sample: Self::Sample) -> f64;

    /// An upper bound of the error between two samples that are `share` of the way from `knot` to the next one apart.
    fn bound(&self, knot: usize, share: f64, ends: [Self::Sample; 2]) -> f64;

    /// What is travelled from a knot to the next, radians and metres.
    fn travel(&self, knot: usize) -> f64;
}

/// A vector whose norm is bounded, and what that norm means.
pub(crate) enum Form {
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
    pub(crate) fn error_at(&self, pose: &Pose) -> f64 {
        self.error(self.norm(pose))
    }

    /// ‖f″‖ over the way from a knot to the next; a direction that turns with ω has ω² + |ω′| at most, and a quaternion turns at
    /// half the speed.
    fn bend(&self, bends: &Bends, knot: usize) -> f64 {
        let (turn, turn_bend) = (bends.turn[knot], bends.turn_bend[knot]);
        let direction = turn * turn + turn_bend;
        match self {
            Self::Rows { .. } => bends.point[knot],
            Self::Height { point, .. } | Self::Outside { point, .. } => bends.point[knot] + point.length() * direction,
            Self::Direction { .. } => direction,
            Self::Rotation { .. } => 0.25 * turn * turn + 0.5 * turn_bend,
        }
    }
}

/// A form of a relative pose along a segment.
pub(crate) struct Formed<'f> {
    pub form: &'f Form,
    pub pose: &'f dyn Fn(At) -> Pose,
    pub bends: &'f Bends,
}

impl Quantity for Formed<'_> {
    type Sample = f64;

    fn sample(&self, at: At) -> f64 {
        self.form.norm(&(self.pose)(at))
    }

    fn error(&self, norm: f64) -> f64 {
        self.form.error(norm)
    }

    fn bound(&self, knot: usize, share: f64, [a, b]: [f64; 2]) -> f64 {
        self.form.error(a.max(b) + self.form.bend(self.bends, knot) * share * share / 8.0)
    }

    fn travel(&self, knot: usize) -> f64 {
        self.bends.travel[knot]
    }
}

/// What is to be proved, for people.
#[derive(Clone, Copy)]
pub(crate) struct Relation<'r> {
    pub kind: Kind,
    pub subject: &'r str,
    pub tolerance: f64,
}

/// Intervals over which more than this is travelled are halved whatever the bound says: the quaternion's sign is
/// followed by nearness, radians and metres.
const LONGEST: f64 = 0.5;
/// An interval whose bound adds less than this share of the tolerance is not halved further.
const FINEST: f64 = 1e-6;
/// Nor is one that is this share of the way between two knots.
const SHORTEST: f64 = 1e-12;

/// Proves that a quantity stays within the tolerance over the whole segment, or reports where it does not.
pub(crate) fn prove<Q: Quantity>(
    motion: &SegmentMotion<'_>,
    quantity: &Q,
    what: &str,
    relation: &Relation<'_>,
    report: &mut CheckReport,
    work: &mut Work,
) {
    let mut prover = Prover { motion, quantity, what, relation, report, work };
    let mut before = prover.sample(At::knot(0));
    for knot in 0..motion.last() {
        let after = prover.sample(At::knot(knot + 1));
        prover.interval(knot, before, after);
        before = after;
        if prover.work.is_over() {
            return;
        }
    }
}

struct Prover<'p, Q> {
    motion: &'p SegmentMotion<'p>,
    quantity: &'p Q,
    what: &'p str,
    relation: &'p Relation<'p>,
    report: &'p mut CheckReport,
    work: &'p mut Work,
}

impl<Q: Quantity> Prover<'_, Q> {
    fn subject(&self) -> String {
        format!("{}: {}", self.relation.subject, self.what)
    }

    /// Measures at a place; reports an error that is too large.
    fn sample(&mut self, at: At) -> Q::Sample {
        self.report.counts.residual_samples += 1;
        let sample = self.quantity.sample(at);
        let error = self.quantity.error(sample);
        // Compared so that NaN is too large.
        let fine = error <= self.relation.tolerance;
        if !fine {
            self.violate(at.t(), error);
        }
        let subject = format_args!("{}: {}", self.relation.subject, self.what);
        self.report.see_residual(error, self.motion.index, at.t(), || subject.to_string());
        sample
    }

    fn violate(&mut self, t: f64, error: f64) {
        let place = Place::at(self.motion.index, t);
        self.report.violate(place, self.relation.kind, self.subject(), error, self.relation.tolerance);
    }

    fn interval(&mut self, knot: usize, before: Q::Sample, after: Q::Sample) {
        let (travel, tolerance) = (self.quantity.travel(knot), self.relation.tolerance);
        let mut stack = vec![(0.0, before, 1.0, after)];
        while let Some((low, at_low, high, at_high)) = stack.pop() {
            let share: f64 = high - low;
            let bound = self.quantity.bound(knot, share, [at_low, at_high]);
            let short = travel * share <= LONGEST;
            if short && bound <= tolerance {
                self.report.residual_bound = self.report.residual_bound.max(bound);
                continue;
            }
            let largest = self.quantity.error(at_low).max(self.quantity.error(at_high));
            // Written so that NaN is too large.
            let fine = largest <= tolerance;
            if !fine {
                return; // reported when it was sampled
            }
            if !self.work.spend(1) {
                return;
            }
            if (short && bound - largest <= FINEST * tolerance) || share <= SHORTEST {
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
