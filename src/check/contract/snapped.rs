//! What the scene has a little off a state of the problem, and the path on it: a planner may move it there and has to say so.
//!
//! The file names the object or joint and how far it was moved; the scene says how far that may be. That the path has it on its
//! state is proved elsewhere: of what a segment says is held or lies, and of the scene's constraints, every row holds (`leaf`,
//! `required_constraints`).

use crate::check::contract::scene_contract::Contract;
use crate::check::motion::segment::SegmentMotion;
use crate::check::report::check_report::shown;
use crate::path_file::document::{CorrectionEntry, PathFile};
use foliate_components::pose::pose_from_array;
use foliate_components::robot::{JointIndex, JointType, Source};
use std::ops::Range;

/// Rounding of what a file says of a correction, metres and radians.
const NEAR: f64 = 1e-5;

impl Contract<'_> {
    /// What the file says was moved of the start (`None`) or of a goal, and may be: from where the scene has it, in `wanted`, to where the
    /// path has it, in `found`.
    pub(super) fn corrected(
        &self,
        file: &PathFile,
        motion: &SegmentMotion<'_>,
        goal: Option<usize>,
        [found, wanted]: [&[f64]; 2],
    ) -> Corrected {
        let entries = file.corrections.iter().filter(|entry| entry.goal == goal);
        Corrected(entries.filter_map(|entry| self.allowed(entry, motion, [found, wanted])).collect())
    }

    /// The numbers that an entry lets differ; none where it says too little, or the scene allows less.
    fn allowed(
        &self,
        entry: &CorrectionEntry,
        motion: &SegmentMotion<'_>,
        [found, wanted]: [&[f64]; 2],
    ) -> Option<(Range<usize>, Vec<f64>, String)> {
        let robot = &self.problem.robot;
        let joint = match (&entry.object, &entry.joint) {
            (Some(object), None) => {
                let part = robot.part(object)?;
                let object = self.problem.graph.objects.iter().find(|object| object.part == part)?;
                // What nothing holds and nothing carries lies in no other place than its own.
                let number = motion.world.part(&robot[part].name)?;
                let is_kept = motion.attachments.iter().any(|attachment| attachment.part == number);
                robot[part].root_joint.filter(|_| is_kept || object.plane.is_some())?
            }
            (None, Some(joint)) => robot.joint(joint).filter(|joint| self.has_to_move(*joint, motion, wanted))?,
            _ => return None,
        };
        let record = &robot.joints[joint.at()];
        let Source::Coordinates { q, .. } = record.source else { return None };
        let numbers = q..q + record.motion.configuration_size();
        let (from, to) = (wanted.get(numbers.clone())?, found.get(numbers.clone())?);
        let (distance, angle) = apart(record.motion, from, to)?;
        let said = (entry.distance - distance).abs() <= NEAR && (entry.angle - angle).abs() <= NEAR;
        let most = self.problem.start_tolerance;
        let within = distance <= most.distance + NEAR && angle <= most.angle + NEAR;
        let name = entry.object.as_ref().or(entry.joint.as_ref()).map(|name| shown(name).to_string())?;
        let told = format!("{name} by {:.2} mm and {:.2} degrees", distance * 1e3, angle.to_degrees());
        (said && within).then(|| (numbers, from.to_vec(), told))
    }
}

impl Contract<'_> {
    /// Whether moving objects alone may not do: a joint is outside its bounds where the scene has it, or a resting one, or a segment
    /// holds an object twice, holds a part that has joints of its own, or has constraints of the scene's own.
    fn has_to_move(&self, joint: JointIndex, motion: &SegmentMotion<'_>, wanted: &[f64]) -> bool {
        let (robot, options) = (&self.problem.robot, &self.problem.graph);
        let Source::Coordinates { q, .. } = robot.joints[joint.at()].source else { return false };
        let space = &robot.space;
        let is_outside = wanted.get(q).is_some_and(|value| !(space.lower[q]..=space.upper[q]).contains(value));
        let grasps = |part: usize| motion.attachments.iter().filter(|a| a.part == part && a.is_grasp()).count();
        let is_tied = |part: usize| grasps(part) > 1 || grasps(part) > 0 && !motion.world.parts[part].floats;
        is_outside
            || options.resting_joints.iter().any(|resting| resting.joint == joint)
            || !options.everywhere.is_empty()
            || !options.while_held.is_empty()
            || options.states.iter().any(|state| !state.constraints.is_empty())
            || (0..motion.world.parts.len()).any(is_tied)
    }
}

/// Numbers that were moved within the tolerance: which, where the scene has them, and by how much, in words.
pub(super) struct Corrected(Vec<(Range<usize>, Vec<f64>, String)>);

impl Corrected {
    /// A configuration with these numbers as the scene has them.
    pub fn with(&self, q: &[f64]) -> Vec<f64> {
        let mut q = q.to_vec();
        self.0.iter().for_each(|(numbers, wanted, _)| q[numbers.clone()].copy_from_slice(wanted));
        q
    }

    /// Says so.
    pub fn told(&self, whose: &str) -> Option<String> {
        let moved: Vec<&str> = self.0.iter().map(|(.., told)| told.as_str()).collect();
        (!moved.is_empty()).then(|| format!("of {whose} the path has moved onto its state: {}", moved.join(", ")))
    }
}

/// How far two values of a joint are apart: metres, radians. None where a quaternion is none.
fn apart(motion: JointType, from: &[f64], to: &[f64]) -> Option<(f64, f64)> {
    let off: Vec<f64> = from.iter().zip(to).map(|(from, to)| to - from).collect();
    Some(match motion {
        JointType::Revolute { .. } => (0.0, off[0].abs()),
        JointType::Prismatic { .. } => (off[0].abs(), 0.0),
        JointType::Planar => (off[0].hypot(off[1]), off[2].abs()),
        JointType::FreeFlyer => {
            let read = |numbers: &[f64]| numbers.try_into().ok().and_then(pose_from_array);
            let (from, to) = (read(from)?, read(to)?);
            let turn = from.rotation.conjugate() * to.rotation;
            let half = glam::DVec3::new(turn.x, turn.y, turn.z).length();
            (from.translation.distance(to.translation), 2.0 * half.atan2(turn.w.abs()))
        }
    })
}
