//! A held object leaves its support along the normal, and comes back to it so, without turning, as the scene asks. The first segment in which it
//! moves, and the last one, keep to that and reach as far as the pre-placement. Where it is when the lift begins is read from the segment itself.

use crate::check::contract::required_constraints::told;
use crate::check::contract::scene_contract::Contract;
use crate::check::leaf::case::Case;
use crate::check::leaf::constraint;
use crate::check::leaf::on_leaf::Leaf;
use crate::check::motion::reach::Reach;
use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::check::report::work::Work;
use crate::check::world::documents::Frames;
use crate::path_file::document::{AttachmentEntry, PathFile, SegmentEntry};
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, RelativePose};
use foliate_components::problem::{Lift, ObjectOptions};
use foliate_components::robot::JointIndex;

/// What is moved by less stands still: by as much an object may be written off its carrier.
const STILL: f64 = 1e-5;

/// What holds while an object is lifted off its support or put down on it.
struct StraightLift {
    name: String,
    line: RelativePose,
    /// Whether the object moves along the segment.
    moves: bool,
}

impl Contract<'_> {
    /// Whether objects leave their supports along a line, and come back to them so, in a segment.
    pub(in crate::check::contract) fn lifts(
        &self,
        file: &PathFile,
        motion: &SegmentMotion<'_>,
        frames: &Frames,
        report: &mut CheckReport,
        work: &mut Work,
    ) -> Result<(), CheckError> {
        let (robot, tolerance) = (&self.problem.robot, file.certificate.path_tolerance);
        for StraightLift { name, line, moves } in self.straight_lifts(file, motion.index) {
            let wanted = |value: Pose| told(robot, &name, Constraint::RelativePose(line), Some(value), tolerance);
            let (reach, mut scratch) = (Reach::new(motion), CheckReport::default());
            let mut leaf = Leaf { motion, file, reach: &reach, report: &mut scratch, work };
            let form = wanted(Pose::identity());
            let case = Case::new(&form[0], frames, "scene");
            let [to, frame] = [("to", &form[0].to), ("frame", &form[0].frame)]
                .map(|(key, entry)| case.frame(&leaf, key, entry.as_ref()));
            let (to, frame) = (to?, frame?);
            let pose = |knot: usize| motion.frame(&to, At::knot(knot)).inverse() * motion.frame(&frame, At::knot(knot));
            for entry in wanted(pose(0)) {
                constraint::check(&mut leaf, &entry, frames, "scene")?;
            }
            for broken in scratch.violations {
                let place = Place { segment: broken.segment, t: broken.t };
                report.violate(place, Kind::Demand, broken.subject, broken.value, broken.limit);
            }
            let along = line.rows.iter().position(Option::is_none).unwrap_or_default();
            let way = (pose(motion.last()).translation - pose(0).translation)[along].abs();
            let asked = self.problem.graph.preplacement_distance;
            let is_far = way >= asked - tolerance;
            if moves && !is_far {
                report.violate(Place::at(motion.index, 0.0), Kind::Demand, format!("{name} ends too low"), way, asked);
            }
        }
        Ok(())
    }

    /// The objects that have left a support before a segment, or come to one after it, and are not lifted as the joints make it.
    fn straight_lifts(&self, file: &PathFile, segment: usize) -> Vec<StraightLift> {
        let options = &self.problem.graph;
        let robot = &self.problem.robot;
        let of_object = |(number, object): (usize, &ObjectOptions)| {
            let part = robot.parts[object.part.at()].name.as_str();
            let own = |column: &usize| file.coordinates[*column].split('/').next() == Some(part);
            let columns: Vec<_> = (0..file.coordinates.len()).filter(own).collect();
            let is_near =
                |knot: &Vec<f64>, place: &Vec<f64>| columns.iter().all(|&at| (knot[at] - place[at]).abs() <= STILL);
            let stays = |segment: &SegmentEntry, place| segment.knots.iter().all(|knot| is_near(knot, place));
            let here = file.segments.get(segment).filter(|_| options.lift == Lift::Straight)?;
            if !is_held(here, part) {
                return None;
            }
            // Where it lay before hands moved it, or lies after: the segments between have it there.
            let before = file.segments[..segment].iter().rposition(|s| !is_held(s, part));
            let after = file.segments[segment + 1..].iter().position(|s| !is_held(s, part)).map(|at| segment + 1 + at);
            let from = before.map(|at| (&file.segments[at], file.segments[at].knots.last(), at + 1..segment));
            let to = after.map(|at| (&file.segments[at], file.segments[at].knots.first(), segment + 1..at));
            [from, to].into_iter().flatten().find_map(|(lies, place, between)| {
                let place = place.filter(|place| file.segments[between].iter().all(|s| stays(s, place)))?;
                let line = options.lift_line(robot, number, self.carrier(lies, part)?)?;
                Some(StraightLift { name: format!("the straight lift of {part}"), line, moves: !stays(here, place) })
            })
        };
        options.objects.iter().enumerate().filter_map(of_object).collect()
    }

    /// The body on which an object lies in a segment in which no gripper holds it; the inner `None` for the world.
    fn carrier(&self, segment: &SegmentEntry, part: &str) -> Option<Option<JointIndex>> {
        let robot = &self.problem.robot;
        let mut own = segment.attachments.iter().filter(|entry| owner(entry) == part);
        if is_held(segment, part) {
            return None;
        }
        let support = own.find_map(|entry| entry.support.as_deref());
        let on =
            |name| robot.surfaces.iter().find(|surface| surface.name == name).map(|s| robot.links[s.link.at()].joint);
        // What stands on a plane stands in the world.
        support.map_or(Some(None), on)
    }
}

/// The part of an attachment's object.
fn owner(entry: &AttachmentEntry) -> &str {
    entry.object.split('/').next().unwrap_or_default()
}

/// Whether a gripper holds a part along a segment.
fn is_held(segment: &SegmentEntry, part: &str) -> bool {
    segment.attachments.iter().any(|entry| owner(entry) == part && entry.gripper.is_some())
}
