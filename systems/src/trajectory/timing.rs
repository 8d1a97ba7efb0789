//! From smooth paths to segments over time: the fastest motion that keeps the limits of velocity and acceleration, with the robot at rest
//! at every stop, and standing still while a hand takes or lets go of something.

use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::Model;
use crate::trajectory::smoothing::{SmoothPath, write_carried};
use crate::trajectory::stretch::Stretch;
use foliate_components::path::{Segment, SegmentTiming};
use foliate_kernels::trajectory::{Limits, TimedPath, TimingError, TimingScratch, TimingSettings, time_optimal};

/// How long a motion takes that is as short as rounding, seconds.
const HARDLY_MOVING: f64 = 1e-3;

/// The segments of a stretch, from `now` on; `now` becomes the time at which the last one ends.
///
/// # Errors
/// Limits that allow no motion.
pub(crate) fn segments(
    model: &Model,
    motions: &[LeafMotion],
    (stretch, paths): (&Stretch, &[SmoothPath]),
    now: &mut f64,
    scratch: &mut TimingScratch,
) -> Result<Vec<Segment>, TimingError> {
    let size = model.problem.robot.space.size();
    let mut rows = Rows::new(model, &motions[stretch.motions.clone()], stretch);
    rows.push(*now, &stretch.knots[..size], None);
    if stretch.begins_with_grasp_change && model.problem.timing.dwell > 0.0 {
        *now += model.problem.timing.dwell;
        rows.push(*now, &stretch.knots[..size], None);
    }
    // Motions that stand still where the stretch begins.
    stretch.joints.iter().filter(|joint| **joint == 0).for_each(|_| rows.next_motion());
    let limits = Limits { velocity: &stretch.velocity, acceleration: &stretch.acceleration, jerk: &stretch.jerk };
    let mut timed = TimedPath::default();
    for path in paths {
        time_optimal(&path.path, limits, TimingSettings::default(), scratch, &mut timed)?;
        let joints: Vec<usize> = path.joints.iter().map(|&joint| cut_at(&mut timed, joint)).collect();
        let curve = &timed.curve;
        for knot in 1..curve.len() {
            rows.push(*now + curve.parameters()[knot], curve.knot(knot), Some(curve.velocity(knot)));
            if joints.contains(&knot) {
                rows.next_motion();
            }
        }
        *now += curve.extent();
    }
    if paths.is_empty() && stretch.knots.len() > size {
        // Rounding is all that moves.
        *now += HARDLY_MOVING;
        rows.push(*now, &stretch.knots[size..], None);
    }
    rows.end_at(&stretch.knots[stretch.knots.len() - size..]);
    Ok(rows.segments())
}

/// Cuts a curve where it passes a parameter of its path, and returns the knot there.
fn cut_at(timed: &mut TimedPath, parameter: f64) -> usize {
    let piece = timed.parameters.partition_point(|p| *p <= parameter).saturating_sub(1);
    let last = timed.curve.pieces();
    if piece >= last || timed.parameters[piece] == parameter {
        return piece.min(last);
    }
    // On a piece the share of the way is that of the coordinate that moves most.
    let share = (parameter - timed.parameters[piece]) / (timed.parameters[piece + 1] - timed.parameters[piece]);
    let (from, to) = (timed.curve.knot(piece), timed.curve.knot(piece + 1));
    let way = |i: usize| (to[i] - from[i]).abs();
    let coordinate = (0..from.len()).max_by(|&a, &b| way(a).total_cmp(&way(b))).unwrap_or(0);
    let cubic = timed.curve.cubic(piece, coordinate);
    let target = from[coordinate] + share * (to[coordinate] - from[coordinate]);
    let rises = to[coordinate] > from[coordinate];
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for _ in 0..60 {
        let middle = low.midpoint(high);
        if (cubic.position(middle) < target) == rises { low = middle } else { high = middle }
    }
    let time = timed.curve.parameters()[piece] + low * timed.curve.width(piece);
    let pieces = timed.curve.pieces();
    let knot = timed.curve.cut(time);
    if timed.curve.pieces() > pieces {
        timed.parameters.insert(knot, parameter);
    }
    knot
}

/// Rows of the segments of a stretch.
struct Rows<'a> {
    model: &'a Model,
    motions: &'a [LeafMotion],
    stretch: &'a Stretch,
    /// By motion.
    timings: Vec<(Vec<Vec<f64>>, SegmentTiming)>,
}

impl<'a> Rows<'a> {
    fn new(model: &'a Model, motions: &'a [LeafMotion], stretch: &'a Stretch) -> Self {
        Self { model, motions, stretch, timings: vec![(Vec::new(), SegmentTiming::default())] }
    }

    /// Adds a knot, at rest where there is no velocity.
    fn push(&mut self, time: f64, q: &[f64], velocity: Option<&[f64]>) {
        let motion = &self.motions[(self.timings.len() - 1).min(self.motions.len() - 1)];
        let Some((knots, timing)) = self.timings.last_mut() else { return };
        let mut q = q.to_vec();
        let mut velocity = velocity.map_or_else(|| vec![0.0; q.len()], <[f64]>::to_vec);
        if !knots.is_empty() {
            write_carried(self.model, motion, &self.stretch.carried, &mut q, &mut velocity);
        }
        knots.push(q);
        timing.times.push(time);
        timing.velocities.push(velocity);
    }

    /// The knots that follow are of the next motion, which begins with the last one.
    fn next_motion(&mut self) {
        if self.timings.len() == self.motions.len() {
            return;
        }
        let joint = self.timings.last().and_then(|(knots, timing)| {
            let (time, velocity) = (*timing.times.last()?, timing.velocities.last()?.clone());
            Some((vec![knots.last()?.clone()], SegmentTiming { times: vec![time], velocities: vec![velocity] }))
        });
        self.timings.extend(joint);
    }

    /// The last knot is the path's own, bit for bit, at rest.
    fn end_at(&mut self, q: &[f64]) {
        if let Some((knots, timing)) = self.timings.last_mut() {
            if let (Some(last), Some(velocity)) = (knots.last_mut(), timing.velocities.last_mut()) {
                last.copy_from_slice(q);
                velocity.fill(0.0);
            }
        }
    }

    fn segments(self) -> Vec<Segment> {
        let Self { model, motions, timings, .. } = self;
        let mut segments = Vec::with_capacity(motions.len());
        let mut timings = timings.into_iter();
        for motion in motions {
            // A motion that has no way of its own stands still where the one before has ended.
            let (knots, timing) = timings.next().unwrap_or_else(|| standstill(&segments));
            segments.push(Segment { knots, timing: Some(timing), ..motion.segment(model) });
        }
        segments.iter_mut().for_each(at_least_two_knots);
        segments
    }
}

/// A knot at rest where the last segment ends.
fn standstill(segments: &[Segment]) -> (Vec<Vec<f64>>, SegmentTiming) {
    let last = segments.last();
    let knot = last.and_then(|segment| segment.knots.last()).cloned().unwrap_or_default();
    let time = last.and_then(|segment| segment.timing.as_ref()?.times.last().copied()).unwrap_or(0.0);
    let velocities = vec![vec![0.0; knot.len()]];
    (vec![knot], SegmentTiming { times: vec![time], velocities })
}

/// A segment without movement has two knots.
fn at_least_two_knots(segment: &mut Segment) {
    if let (1, Some(timing)) = (segment.knots.len(), &mut segment.timing) {
        segment.knots.push(segment.knots[0].clone());
        timing.times.push(timing.times[0]);
        timing.velocities.push(timing.velocities[0].clone());
    }
}
