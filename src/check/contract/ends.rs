//! The path begins where the scene says and ends at one of its goals.

use super::goals::End;
use super::required_constraints::all_hold;
use crate::check::contract::scene_contract::Contract;
use crate::check::motion::segment::SegmentMotion;
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::check::report::work::Work;
use crate::check::world::documents::Frames;
use crate::path_file::document::{PathFile, SegmentEntry};
use foliate_components::Pose;
use foliate_components::pose::{pose_from_array, pose_to_array};
use foliate_components::problem::{Goal, PartialGoal};
use foliate_components::robot::{JointType, Robot, Source};
use std::f64::consts::TAU;

/// How far the ends may be from the scene's, metres and radians: the accuracy of projections.
const NEAR: f64 = 1e-5;

impl Contract<'_> {
    /// Checks the first and the last segment.
    pub(in crate::check) fn ends(
        &self,
        file: &PathFile,
        motion: &SegmentMotion<'_>,
        frames: &Frames,
        report: &mut CheckReport,
        work: &mut Work,
    ) -> Result<(), CheckError> {
        let columns = self.columns(file);
        let Some(columns) = columns.into_iter().collect::<Option<Vec<usize>>>() else { return Ok(()) };
        let seen = |knot: &[f64]| columns.iter().map(|&column| knot[column]).collect::<Vec<f64>>();
        if motion.index == 0 {
            let found = seen(&motion.knots[0]);
            let onto = self.corrected(file, motion, None, [&found, &self.problem.start]);
            let (off, name) = self.off(&onto.with(&found), &self.problem.start);
            // Compared so that NaN is off.
            let there = off <= NEAR;
            if !there {
                report.violate(
                    Place::at(0, 0.0),
                    Kind::Start,
                    format!("{name} is not where the scene starts"),
                    off,
                    NEAR,
                );
            } else if let Some(text) = onto.told("the start") {
                report.note(text);
            }
        }
        if motion.index + 1 == file.segments.len() {
            let last = seen(&motion.knots[motion.last()]);
            let mut nearest = (f64::INFINITY, String::from("the scene has no goal"));
            let mut told = None;
            for (number, goal) in self.problem.goals.iter().enumerate() {
                let wanted = wanted(&self.problem.robot, goal, &last);
                let onto = self.corrected(file, motion, Some(number), [&last, &wanted]);
                let mut off = self.off(&onto.with(&last), &wanted);
                if let Goal::Partial(partial) = goal {
                    let end = End { file, motion, frames, last: &last };
                    let unmet = self.unmet(partial, &end).map(|unmet| (f64::INFINITY, unmet));
                    off = self.broken(partial, file, motion, frames, work)?.or(unmet).unwrap_or(off);
                }
                if off.0 < nearest.0 || nearest.0.is_infinite() {
                    (nearest, told) = (off, onto.told("a goal"));
                }
            }
            let (off, what) = nearest;
            let there = off <= NEAR;
            if !there {
                let place = Place::at(motion.index, motion.last() as f64);
                let off = Some(off).filter(|off| off.is_finite());
                report.violate(place, Kind::Goal, format!("{what} is not where a goal has it"), off, NEAR);
            } else if let Some(text) = told {
                report.note(text);
            }
        }
        Ok(())
    }

    /// The largest difference of two configurations, and whose: metres, radians; of rotations half of their angle at most.
    fn off(&self, found: &[f64], wanted: &[f64]) -> (f64, String) {
        let mut worst = (0.0, String::new());
        let mut see = |off: f64, name: &str| {
            // Written so that NaN is the worst.
            let better = off <= worst.0;
            if !better {
                worst = (off, name.to_owned());
            }
        };
        for joint in &self.problem.robot.joints {
            let Source::Coordinates { q, .. } = joint.source else { continue };
            let linear = if joint.motion == JointType::FreeFlyer { 3 } else { joint.motion.configuration_size() };
            for i in q..q + linear {
                let turns = matches!(joint.motion, JointType::Revolute { .. })
                    || (joint.motion == JointType::Planar && i == q + 2);
                let endless = !joint.lower[i - q].is_finite() && !joint.upper[i - q].is_finite();
                let off = found[i] - wanted[i];
                // Angles without limits are unwrapped numbers: full turns make no difference.
                let off = if turns && endless { off - TAU * (off / TAU).round() } else { off };
                see(off.abs(), &self.names[i]);
            }
            if joint.motion == JointType::FreeFlyer {
                see(quaternions_off(&found[q + 3..q + 7], &wanted[q + 3..q + 7]), &joint.name);
            }
        }
        worst
    }

    /// The constraint of a partial goal that does not hold, infinitely far off.
    fn broken(
        &self,
        goal: &PartialGoal,
        file: &PathFile,
        motion: &SegmentMotion<'_>,
        frames: &Frames,
        work: &mut Work,
    ) -> Result<Option<(f64, String)>, CheckError> {
        let robot = &self.problem.robot;
        let entry = &file.segments[motion.index];
        let end = SegmentEntry {
            transition: entry.transition.clone(),
            state: entry.state.clone(),
            attachments: Vec::new(),
            constraints: Vec::new(),
            knots: vec![motion.knots[motion.last()].clone()],
            times: None,
            velocities: None,
        };
        let at_end = SegmentMotion::new(motion.world, &end, motion.index, motion.attachments)?;
        for named in &goal.constraints {
            if !all_hold(robot, named, &at_end, file, frames, work)? {
                return Ok(Some((f64::INFINITY, format!("constraint `{}` of a goal", named.name))));
            }
        }
        Ok(None)
    }
}

/// Where a goal has everything; what it leaves free is where it is.
fn wanted(robot: &Robot, goal: &Goal, last: &[f64]) -> Vec<f64> {
    let goal = match goal {
        Goal::Configuration(wanted) => return wanted.clone(),
        Goal::Partial(goal) => goal,
    };
    let mut wanted = last.to_vec();
    for (part, pose) in &goal.poses {
        let root = robot.parts[part.at()].root_joint.map(|joint| &robot.joints[joint.at()]);
        if let Some(Source::Coordinates { q, .. }) = root.map(|joint| joint.source) {
            wanted[q..q + 7].copy_from_slice(&pose_to_array(pose));
        }
    }
    goal.coordinates.iter().for_each(|&(index, value)| wanted[index] = value);
    wanted
}

fn quaternions_off(found: &[f64], wanted: &[f64]) -> f64 {
    let read =
        |q: &[f64]| pose_from_array([0.0, 0.0, 0.0, q[0], q[1], q[2], q[3]]).unwrap_or(Pose::identity()).rotation;
    let (found, wanted) = (read(found), read(wanted));
    (found - wanted).length().min((found + wanted).length())
}
