//! A path with times, and the robot that moves along it.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::planner::trajectory::curve::{Interpolation, Piece};
use crate::planner::trajectory::error::TrajectoryError;
use crate::planner::trajectory::sample_times::SampleTimes;
use foliate_components::Pose;
use foliate_components::path::{Attachment, ManipulationPath, Segment, SegmentTiming};
use foliate_components::robot::configuration::Group;
use foliate_components::robot::{JointIndex, JointType, LinkIndex, PartKind, Robot, Source};
use foliate_kernels::kinematics::Kinematics;
#[cfg(feature = "view")]
use glam::DQuat;

/// An object that follows a body during a segment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried {
    /// Root joint of the object.
    pub object: JointIndex,
    /// The body of the object that is held, mostly its root.
    pub held: JointIndex,
    /// The body that carries; none for the world.
    pub carrier: Option<JointIndex>,
    /// The link that carries; none where nothing is named.
    pub link: Option<LinkIndex>,
    /// Constant along the segment.
    pub carrier_from_held: Pose,
}

/// A path with times, and the robot that moves along it: positions, velocities and accelerations of joints, poses of links and objects at
/// any time, what hands hold and when that changes.
///
/// Times are seconds, as the path counts them: from 0 in what a planner answers. Times before the start count as the start, times after
/// the end as the end; NaN counts as the start. Where two segments meet, the later one answers, so that at the time of a grasp the object is
/// held. Poses are in the world; angles are radians, lengths metres.
#[derive(Clone, Debug)]
pub struct Trajectory<'a> {
    pub(super) robot: &'a Robot,
    pub(super) path: &'a ManipulationPath,
    /// By segment.
    pub(super) states: Vec<&'a str>,
    interpolation: Interpolation,
    pub(super) kinematics: Kinematics,
    /// By segment.
    pub(super) carried: Vec<Vec<Carried>>,
}

/// A moment of a trajectory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment<'a> {
    /// Number of the segment.
    pub segment: usize,
    /// Where on it.
    pub piece: Piece<'a>,
}

impl<'a> Trajectory<'a> {
    /// Looks at a path of a robot. `states` has a name for every segment.
    ///
    /// # Errors
    /// No segments, or segments without times; knots, times or velocities that do not fit together or are not finite; times that
    /// decrease.
    ///
    /// # Panics
    /// If an attachment names a gripper, link or joint that the robot does not have, or there are too few names.
    pub fn new(
        robot: &'a Robot,
        path: &'a ManipulationPath,
        states: Vec<&'a str>,
        interpolation: Interpolation,
    ) -> Result<Self, TrajectoryError> {
        assert!(states.len() >= path.segments.len(), "a name for each segment");
        if path.segments.is_empty() {
            return Err(TrajectoryError::Empty);
        }
        let mut before = f64::NEG_INFINITY;
        for (number, segment) in path.segments.iter().enumerate() {
            let timing = segment.timing.as_ref().ok_or(TrajectoryError::NoTimes)?;
            let message = wrong(segment, timing, robot.space.size(), interpolation, before);
            if let Some(message) = message {
                return Err(TrajectoryError::Malformed { segment: number, message });
            }
            before = timing.times[timing.times.len() - 1];
        }
        let kinematics = Kinematics::new(robot);
        let carried = path.segments.iter().map(|segment| carried(robot, &kinematics, segment)).collect();
        Ok(Self { robot, path, states, interpolation, kinematics, carried })
    }

    /// The robot: all parts as one tree.
    #[must_use]
    pub fn robot(&self) -> &'a Robot {
        self.robot
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &'a ManipulationPath {
        self.path
    }

    /// How it goes from knot to knot.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// When it begins, seconds: 0 in what a planner answers.
    #[must_use]
    pub fn start(&self) -> f64 {
        self.times(0)[0]
    }

    /// When it ends, seconds.
    #[must_use]
    pub fn end(&self) -> f64 {
        let times = self.times(self.path.segments.len() - 1);
        times[times.len() - 1]
    }

    /// How long it takes, seconds.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.end() - self.start()
    }

    /// Times at a rate (samples per second): the start, then one every 1/rate seconds, and last exactly the end. The last step may be
    /// shorter.
    ///
    /// # Errors
    /// The rate is not positive and finite, or gives more than ten million samples.
    pub fn sample_times(&self, rate: f64) -> Result<SampleTimes, TrajectoryError> {
        SampleTimes::new(self.start(), self.end(), rate)
    }

    /// Names of the parts that are robots.
    pub fn robots(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        let robot = self.robot;
        robot.parts.iter().filter(|part| part.kind == PartKind::Robot).map(|part| part.name.as_str())
    }

    /// Names of the parts that are objects.
    pub fn objects(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        let robot = self.robot;
        robot.parts.iter().filter(|part| part.kind == PartKind::Object).map(|part| part.name.as_str())
    }

    /// The times of a segment's knots.
    pub(super) fn times(&self, segment: usize) -> &'a [f64] {
        self.path.segments[segment].timing.as_ref().map_or(&[], |timing| &timing.times)
    }

    /// Where on the path a time is.
    pub(crate) fn moment(&self, time: f64) -> Moment<'a> {
        let segments = &self.path.segments;
        let segment = segments.partition_point(|s| s.timing.as_ref().is_some_and(|t| t.times[0] <= time));
        let segment = segment.saturating_sub(1);
        let (knots, times) = (&segments[segment].knots, self.times(segment));
        let next = times.partition_point(|t| *t <= time).clamp(1, times.len() - 1);
        let (start, end) = (times[next - 1], times[next]);
        let duration = end - start;
        let u = if time >= end { 1.0 } else { ((time - start) / duration).max(0.0) };
        let velocities = segments[segment].timing.as_ref().map(|timing| &timing.velocities);
        let velocities = velocities.filter(|_| self.interpolation == Interpolation::Hermite);
        let velocities = velocities.map(|rows| (rows[next - 1].as_slice(), rows[next].as_slice()));
        let piece = Piece { from: &knots[next - 1], to: &knots[next], velocities, duration, u };
        Moment { segment, piece }
    }

    /// The configuration at a moment. Objects with a carrier are written as at the knot before: see [`super::Poses`].
    pub(super) fn write(&self, moment: &Moment<'_>, q: &mut [f64]) {
        let roots = &self.carried[moment.segment];
        for joint in &self.robot.space.factors {
            let is_carried = roots.iter().any(|carried| self.first_coordinate(carried.object) == Some(joint.q));
            match joint.group {
                Group::FreeFlyer if is_carried => {
                    q[joint.q..joint.q + 7].copy_from_slice(&moment.piece.from[joint.q..joint.q + 7]);
                }
                Group::FreeFlyer => {
                    (joint.q..joint.q + 3).for_each(|i| q[i] = moment.piece.number(i)[0]);
                    let turned = moment.piece.quaternion(joint.q + 3);
                    (0..4).for_each(|n| q[joint.q + 3 + n] = turned[n][0]);
                }
                Group::Plane => (joint.q..joint.q + 3).for_each(|i| q[i] = moment.piece.number(i)[0]),
                Group::Real | Group::Circle => q[joint.q] = moment.piece.number(joint.q)[0],
            }
        }
    }

    /// The velocity at a time, in the robot's velocity coordinates: of free-flyers the translation in the joint's frame, then the rotation in
    /// the moving one. 0 for objects with a carrier, which have none of their own.
    #[cfg(feature = "view")]
    pub(crate) fn velocity(&self, time: f64, velocity: &mut [f64]) {
        let moment = self.moment(time);
        let roots = &self.carried[moment.segment];
        for joint in &self.robot.space.factors {
            let is_carried = roots.iter().any(|carried| self.first_coordinate(carried.object) == Some(joint.q));
            let rate = |i: usize| moment.piece.number(i)[1];
            match joint.group {
                Group::FreeFlyer if is_carried => velocity[joint.v..joint.v + 6].fill(0.0),
                Group::FreeFlyer => {
                    (0..3).for_each(|n| velocity[joint.v + n] = rate(joint.q + n));
                    let turned = moment.piece.quaternion(joint.q + 3);
                    let [q, q_rate] = [0, 1].map(|d| DQuat::from_array(std::array::from_fn(|n| turned[n][d])));
                    let turning = (q.conjugate() * q_rate).xyz() * 2.0;
                    velocity[joint.v + 3..joint.v + 6].copy_from_slice(&turning.to_array());
                }
                Group::Plane => (0..3).for_each(|n| velocity[joint.v + n] = rate(joint.q + n)),
                Group::Real | Group::Circle => velocity[joint.v] = rate(joint.q),
            }
        }
    }

    /// By body the one that it is rigidly one with along a segment, itself where it moves on its own; none where that is the world.
    pub(crate) fn rigid_bodies(&self, segment: usize) -> Vec<Option<JointIndex>> {
        let robot = self.robot;
        let own = |index: usize| {
            let joint = &robot.joints[index];
            let stands = joint.is_immovable() || robot.parts[joint.part.at()].kind == PartKind::Environment;
            let here = JointIndex(index as u32);
            if stands { joint.parent } else { Some(here) }
        };
        let mut next: Vec<Option<JointIndex>> = (0..robot.joints.len()).map(own).collect();
        for carried in self.carried[segment].iter().filter(|carried| carried.held == carried.object) {
            next[carried.object.at()] = carried.carrier;
        }
        let last = |index: usize| {
            let mut here = Some(JointIndex(index as u32));
            // Objects that carry each other in a circle end anywhere.
            for _ in 0..=next.len() {
                match here.map(|body| (body, next[body.at()])) {
                    Some((body, Some(further))) if further != body => here = Some(further),
                    Some((_, None)) => here = None,
                    _ => break,
                }
            }
            here
        };
        (0..next.len()).map(last).collect()
    }

    pub(super) fn first_coordinate(&self, joint: JointIndex) -> Option<usize> {
        match self.robot.joints[joint.at()].source {
            Source::Coordinates { q, .. } => Some(q),
            Source::Follows { .. } => None,
        }
    }
}

/// What is wrong with the numbers of a segment, which may not begin before the last one ends.
fn wrong(
    segment: &Segment,
    timing: &SegmentTiming,
    size: usize,
    interpolation: Interpolation,
    before: f64,
) -> Option<&'static str> {
    let fits = |rows: &[Vec<f64>]| rows.iter().all(|row| row.len() == size && row.iter().all(|x| x.is_finite()));
    let (knots, times) = (&segment.knots, &timing.times);
    let needs_velocities = interpolation == Interpolation::Hermite;
    if knots.len() < 2 {
        Some("has fewer than two knots")
    } else if times.len() != knots.len() {
        Some("has another number of times than of knots")
    } else if needs_velocities && timing.velocities.len() != knots.len() {
        Some("has another number of velocities than of knots")
    } else if !fits(knots) || (needs_velocities && !fits(&timing.velocities)) {
        Some("has a row that is not finite, or not of as many numbers as there are coordinates")
    } else if !times.iter().all(|t| t.is_finite()) || times[0] < before || times.windows(2).any(|t| t[0] > t[1]) {
        Some("has times that decrease, or are not finite")
    } else {
        None
    }
}

/// What follows which body along a segment, from where its first knot has them. An object that is held and has no carrier moves as it is
/// written; one that nothing holds or carries stays.
fn carried(robot: &Robot, kinematics: &Kinematics, segment: &Segment) -> Vec<Carried> {
    let X_WJ = kinematics.poses(&segment.knots[0]);
    let mut carried = Vec::new();
    for part in robot.parts.iter().filter(|part| part.kind == PartKind::Object) {
        let Some(object) = part.root_joint.filter(|j| robot.joints[j.at()].motion == JointType::FreeFlyer) else {
            continue;
        };
        let is_of_part = |joint: JointIndex| part.joints.contains(&joint.at());
        let mut holds = segment.attachments.iter().map(|a| holder(robot, a)).filter(|h| is_of_part(h.object));
        let carrier = holds.clone().find(|hold| hold.carries);
        let (held, link) = match carrier {
            Some(hold) => (hold.held, hold.by),
            None if holds.next().is_some() => continue,
            None => (object, None),
        };
        let carrier = link.and_then(|link| robot.links[link.at()].joint);
        let X_WC = carrier.map_or(Pose::identity(), |body| X_WJ[body.at()]);
        carried.push(Carried { object, held, carrier, link, carrier_from_held: X_WC.inverse() * X_WJ[held.at()] });
    }
    carried
}

/// How an object is held or carried.
#[derive(Clone, Copy)]
struct Hold {
    /// A joint of the object.
    object: JointIndex,
    /// The body of it that is held.
    held: JointIndex,
    /// The link that holds; none where none is named.
    by: Option<LinkIndex>,
    carries: bool,
}

fn holder(robot: &Robot, attachment: &Attachment) -> Hold {
    let body = |link: LinkIndex| robot.links[link.at()].joint;
    match *attachment {
        Attachment::Grasp { object, gripper, handle, carrier } => {
            let held = body(robot.handles[handle.at()].link).unwrap_or(object);
            Hold { object, held, by: Some(robot.grippers[gripper.at()].link), carries: carrier }
        }
        Attachment::Contact { object, surface, support } => {
            let held = body(robot.surfaces[surface.0.at()].link).unwrap_or(object);
            Hold { object, held, by: Some(robot.surfaces[support.0.at()].link), carries: true }
        }
        Attachment::Rest { object, on } => Hold { object, held: object, by: on, carries: true },
    }
}
