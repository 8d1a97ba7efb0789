//! What a path file says of the times of a path: limits of rates, events, and how much of the limits is used.

use crate::path_file::document::{EventEntry, RateLimitEntry};
use crate::path_file::names::held;
use crate::scene::assemble::names::configuration::coordinate_names;
use foliate_components::path::{
    Attachment, EventKind, ManipulationPath, Segment, SegmentTiming, events as events_of, fingers, knot_of_event,
};
use foliate_components::problem::{Problem, RateLimits};
use foliate_components::robot::{GripperIndex, JointIndex, PartKind, Robot, RootJoint, Source};
use std::collections::BTreeMap;

/// Accelerations on both sides of a knot are one where they differ by no more than this share of their limit.
const AGREE: f64 = 1e-6;

/// How much of the limits a path uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shares {
    /// The largest share of a velocity limit.
    pub velocity: f64,
    /// The largest share of an acceleration limit.
    pub acceleration: f64,
    /// 1: velocity is continuous, 2: acceleration too.
    pub continuity: u8,
}

/// The finite limits of a problem, by coordinate; none where the path has no times.
pub(super) fn rate_limits(problem: &Problem, path: &ManipulationPath) -> Option<BTreeMap<String, RateLimitEntry>> {
    path.segments.iter().find_map(|segment| segment.timing.as_ref())?;
    let limits = RateLimits::of(&problem.robot, &problem.timing);
    let finite = |limit: f64| limit.is_finite().then_some(limit);
    let entry = |(index, name): (usize, String)| {
        let velocity = finite(limits.velocity[index]);
        let acceleration = finite(limits.acceleration[index]);
        let entry = RateLimitEntry { velocity, acceleration, jerk: finite(limits.jerk[index]) };
        (entry != RateLimitEntry::default()).then_some((name, entry))
    };
    Some(coordinate_names(&problem.robot).into_iter().enumerate().filter_map(entry).collect())
}

/// The events of a path, with the positions of the fingers.
pub(super) fn events(robot: &Robot, path: &ManipulationPath) -> Vec<EventEntry> {
    let entry = |event: foliate_components::path::Event| EventEntry {
        time: event.time,
        dwell: event.dwell,
        segment: event.segment,
        kind: match event.kind {
            EventKind::Grasp => "grasp",
            EventKind::Release => "release",
        }
        .into(),
        object: held(robot, event.handle),
        gripper: robot.grippers[event.gripper.at()].name.clone(),
        handle: robot.handles[event.handle.at()].name.clone(),
        fingers: finger_positions(robot, event.gripper, &path.segments[event.segment]),
    };
    events_of(path).into_iter().map(entry).collect()
}

/// Positions of a gripper's joints when what an event says is done.
fn finger_positions(robot: &Robot, gripper: GripperIndex, segment: &Segment) -> BTreeMap<String, f64> {
    let coordinate = |joint: &JointIndex| match robot.joints[joint.at()].source {
        Source::Coordinates { q, .. } => Some(q),
        Source::Follows { .. } => None,
    };
    let joints = fingers(robot, gripper);
    let coordinates: Vec<usize> = joints.iter().filter_map(coordinate).collect();
    let q = knot_of_event(segment, &coordinates);
    let position = |joint: &JointIndex| Some((robot.joints[joint.at()].name.clone(), q[coordinate(joint)?]));
    joints.iter().filter_map(position).collect()
}

/// By coordinate, whether it moves as the knots say: all but those of objects that follow a carrier or rest.
fn moves_as_written(robot: &Robot, segment: &Segment) -> Vec<bool> {
    let mut counts = vec![true; robot.space.size()];
    for (index, part) in robot.parts.iter().enumerate() {
        if (part.kind, part.root) != (PartKind::Object, RootJoint::FreeFlyer) {
            continue;
        }
        let of_part = |object: JointIndex| robot.joints[object.at()].part.at() == index;
        let (mut is_held, mut is_carried) = (false, false);
        for attachment in &segment.attachments {
            match *attachment {
                Attachment::Grasp { object, carrier, .. } if of_part(object) => {
                    (is_held, is_carried) = (true, is_carried || carrier);
                }
                Attachment::Contact { object, .. } | Attachment::Rest { object, .. } if of_part(object) => {
                    is_carried = true;
                }
                _ => {}
            }
        }
        let root = part.root_joint.map(|joint| robot.joints[joint.at()].source);
        if let Some(Source::Coordinates { q, .. }) = root.filter(|_| is_carried || !is_held) {
            counts[q..q + 7].fill(false);
        }
    }
    counts
}

/// How much of its limits a path uses; none without times.
pub(super) fn shares(problem: &Problem, path: &ManipulationPath) -> Option<Shares> {
    path.segments.iter().find_map(|segment| segment.timing.as_ref())?;
    let limits = RateLimits::of(&problem.robot, &problem.timing);
    let mut found = Shares { velocity: 0.0, acceleration: 0.0, continuity: 2 };
    // Accelerations at the end of the piece before; a path begins and ends at rest.
    let mut before = vec![0.0; problem.robot.space.size()];
    for segment in &path.segments {
        let Some(timing) = &segment.timing else { continue };
        let counts = moves_as_written(&problem.robot, segment);
        for knot in 0..segment.knots.len() - 1 {
            for (index, before) in before.iter_mut().enumerate() {
                let (limit, acceleration_limit) = (limits.velocity[index], limits.acceleration[index]);
                let piece = Piece::of(segment, timing, knot, index).filter(|_| counts[index]);
                let Some(piece) = piece.or((!counts[index]).then_some(Piece::STILL)) else { continue };
                let [start, end] = piece.accelerations();
                found.velocity = found.velocity.max(piece.fastest() / limit);
                found.acceleration = found.acceleration.max(start.abs().max(end.abs()) / acceleration_limit);
                found.agree(start, *before, acceleration_limit);
                *before = end;
            }
        }
    }
    before.iter().zip(&limits.acceleration).for_each(|(&end, &limit)| found.agree(end, 0.0, limit));
    Some(found)
}

impl Shares {
    fn agree(&mut self, one: f64, other: f64, limit: f64) {
        let scale = if limit.is_finite() { limit } else { 1.0 + one.abs() };
        if (one - other).abs() > AGREE * scale {
            self.continuity = 1;
        }
    }
}

/// A cubic Hermite polynomial from one knot to the next: duration, change, velocities at both ends.
struct Piece {
    duration: f64,
    by: f64,
    velocities: [f64; 2],
}

impl Piece {
    const STILL: Self = Self { duration: 1.0, by: 0.0, velocities: [0.0; 2] };

    /// The piece of a coordinate; none where it takes no time.
    fn of(segment: &Segment, timing: &SegmentTiming, knot: usize, index: usize) -> Option<Self> {
        let duration = timing.times[knot + 1] - timing.times[knot];
        let by = segment.knots[knot + 1][index] - segment.knots[knot][index];
        let velocities = [timing.velocities[knot][index], timing.velocities[knot + 1][index]];
        (duration > 0.0).then_some(Self { duration, by, velocities })
    }

    /// The largest speed: at an end, or where the acceleration is zero.
    fn fastest(&self) -> f64 {
        let [v, w] = self.velocities;
        let mean = self.by / self.duration;
        let ends = v.abs().max(w.abs());
        // The velocity is v + 2 b s + 3 c s², s from 0 to 1.
        let (b, c) = (3.0 * mean - 2.0 * v - w, v + w - 2.0 * mean);
        let crest = -b / (3.0 * c);
        if crest > 0.0 && crest < 1.0 { ends.max((v + b * crest).abs()) } else { ends }
    }

    /// Accelerations at both ends; between them it is linear.
    fn accelerations(&self) -> [f64; 2] {
        let [v, w] = self.velocities;
        let mean = self.by / self.duration;
        [(6.0 * mean - 4.0 * v - 2.0 * w) / self.duration, (2.0 * v + 4.0 * w - 6.0 * mean) / self.duration]
    }
}
