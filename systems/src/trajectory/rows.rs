//! The knots of a stretch with their times and velocities, motion by motion.

use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::Model;
use crate::search::timed_certificate::object_numbers;
use crate::trajectory::smoothing::write_carried;
use crate::trajectory::stretch::Stretch;
use foliate_components::path::{Segment, SegmentTiming};
use foliate_components::robot::configuration::Group;
use std::ops::Range;

/// Knots, times and velocities of the segments of a stretch.
pub(crate) struct Rows<'a> {
    model: &'a Model,
    motions: &'a [LeafMotion],
    stretch: &'a Stretch,
    /// By motion.
    segments: Vec<(Vec<Vec<f64>>, SegmentTiming)>,
}

impl<'a> Rows<'a> {
    /// The first knot, at rest at time 0.
    pub(crate) fn beginning_at(model: &'a Model, motions: &'a [LeafMotion], stretch: &'a Stretch, q: &[f64]) -> Self {
        let first = (vec![q.to_vec()], SegmentTiming { times: vec![0.0], velocities: vec![vec![0.0; q.len()]] });
        Self { model, motions, stretch, segments: vec![first] }
    }

    /// Repeats the last knot, at rest.
    pub(crate) fn stand_still_until(&mut self, time: f64) {
        if let Some((knots, timing)) = self.segments.last_mut() {
            knots.extend(knots.last().cloned());
            timing.velocities.push(vec![0.0; self.stretch.carried.len()]);
            timing.times.push(time);
        }
    }

    /// Adds a knot. Objects that follow a carrier are written where it takes them.
    pub(crate) fn push(&mut self, time: f64, q: &[f64], velocity: &[f64]) {
        let motion = &self.motions[(self.segments.len() - 1).min(self.motions.len() - 1)];
        let Some((knots, timing)) = self.segments.last_mut() else { return };
        let (mut q, mut velocity) = (q.to_vec(), velocity.to_vec());
        if let Some(last) = knots.last() {
            // Quaternions keep the signs that they have.
            q.iter_mut()
                .zip(last)
                .zip(&self.stretch.carried)
                .filter(|(_, carried)| **carried)
                .for_each(|((x, last), _)| *x = *last);
        }
        write_carried(self.model, motion, &self.stretch.carried, &mut q, &mut velocity);
        knots.push(q);
        timing.times.push(time);
        timing.velocities.push(velocity);
    }

    /// The knots that follow are of the next motion, which begins with the last one.
    pub(crate) fn next_motion(&mut self) {
        if self.segments.len() == self.motions.len() {
            return;
        }
        let joint = self.segments.last().and_then(|(knots, timing)| {
            let (time, velocity) = (*timing.times.last()?, timing.velocities.last()?.clone());
            Some((vec![knots.last()?.clone()], SegmentTiming { times: vec![time], velocities: vec![velocity] }))
        });
        self.segments.extend(joint);
    }

    /// The segments. The last knot is the path's own, at rest.
    pub(crate) fn segments(mut self, end: &[f64]) -> Vec<Segment> {
        // A motion without a way of its own stands still where the one before has ended.
        (self.segments.len()..self.motions.len()).for_each(|_| self.next_motion());
        if let Some((knots, timing)) = self.segments.last_mut()
            && let (Some(last), Some(velocity)) = (knots.last_mut(), timing.velocities.last_mut())
        {
            if timing.times.len() > 1 {
                last.copy_from_slice(end);
            }
            velocity.fill(0.0);
        }
        let Self { model, motions, segments, .. } = self;
        let segment = |(motion, (knots, timing)): (&LeafMotion, (Vec<Vec<f64>>, SegmentTiming))| {
            // A motion that takes no time where the robot moves is no motion: the next one lies on the same leaf.
            let is_none = knots.len() == 1 && timing.velocities[0].iter().any(|v| *v != 0.0);
            let mut segment = Segment { knots, timing: Some(timing), ..motion.segment(model) };
            at_least_two_knots(&mut segment);
            (!is_none).then_some(segment)
        };
        motions.iter().zip(segments).filter_map(segment).collect()
    }
}

/// A segment without movement has two knots.
fn at_least_two_knots(segment: &mut Segment) {
    if let (1, Some(timing)) = (segment.knots.len(), &mut segment.timing) {
        segment.knots.push(segment.knots[0].clone());
        timing.times.push(timing.times[0]);
        timing.velocities.push(timing.velocities[0].clone());
    }
}

/// Makes the signs of quaternions continuous along all knots. A carried object may turn farther between two knots of the path without
/// times than between two of the curve.
pub(crate) fn follow_signs(model: &Model, segments: &mut [Segment]) {
    let factors = &model.problem.robot.space.factors;
    let roots: Vec<usize> = factors.iter().filter(|f| f.group == Group::FreeFlyer).map(|f| f.q + 3).collect();
    let mut last: Option<Vec<f64>> = None;
    for segment in segments {
        let Some(timing) = &mut segment.timing else { continue };
        for (knot, velocity) in segment.knots.iter_mut().zip(&mut timing.velocities) {
            for &q in &roots {
                let along = |last: &Vec<f64>| (q..q + 4).map(|i| last[i] * knot[i]).sum::<f64>();
                if last.as_ref().is_some_and(|last| along(last) < 0.0) {
                    knot[q..q + 4].iter_mut().chain(&mut velocity[q..q + 4]).for_each(|x| *x = -*x);
                }
            }
            last = Some(knot.clone());
        }
    }
}

/// Makes segments share their joint knots bit for bit: objects are where the later segment has them, which differs by rounding. A
/// segment that stands still stands where the next one begins.
pub(crate) fn share_joint_knots(model: &Model, segments: &mut [Segment]) {
    let objects = object_numbers(model);
    for index in (0..segments.len()).rev() {
        let next = segments.get(index + 1).map(|next| next.knots[0].clone());
        let segment = &mut segments[index];
        let Some(joint) = next.or_else(|| segment.knots.last().cloned()) else { continue };
        if is_still(&objects, segment) {
            segment.knots.iter_mut().for_each(|knot| knot.clone_from(&joint));
        } else if let Some(last) = segment.knots.last_mut() {
            last.clone_from(&joint);
        }
    }
}

/// Numbers that differ by less differ by rounding: metres and radians.
const ROUNDING: f64 = 1e-9;

/// An object that two hands hold is written where one of them has it, and then where the other has it. These differ by what projections
/// leave, metres and radians.
const HANDED_OVER: f64 = 1e-5;

/// Whether nothing moves along a segment.
fn is_still(objects: &[Range<usize>], segment: &Segment) -> bool {
    let at_rest = segment.timing.as_ref().is_some_and(|t| t.velocities.iter().flatten().all(|v| *v == 0.0));
    let room = |i: usize| if objects.iter().any(|numbers| numbers.contains(&i)) { HANDED_OVER } else { ROUNDING };
    let near = |pair: &[Vec<f64>]| {
        let mut numbers = pair[0].iter().zip(&pair[1]).enumerate();
        numbers.all(|(i, (a, b))| (a - b).abs() <= room(i))
    };
    at_rest && segment.knots.windows(2).all(near)
}
