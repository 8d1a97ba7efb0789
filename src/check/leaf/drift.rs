//! Steps that add up: within a segment an object may be written some micrometres off its carrier, and over thousands of
//! segments that is a motion. What is attached to one body through consecutive segments stays where the first of them has it,
//! and all steps of a path together are bounded too; unheld joints of objects likewise.

use crate::check::leaf::articulation::{held_beyond, joints_of_objects};
use crate::check::motion::segment::{At, SegmentMotion, Via};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::kind::Kind;
use crate::path_file::document::PathFile;
use foliate_components::Pose;
use foliate_components::robot::PartKind;

/// How far what one body carries may be from where it was when that began, metres and radians; unheld joints likewise.
const TOLERANCE: f64 = 1e-5;
/// What all steps of an object together may be before any change of carriers: a start and a goal that are as far off as one
/// segment may be, metres and radians.
const BOTH_ENDS: f64 = 2.0 * TOLERANCE;
/// How much every change of carriers may add to them: three rows of a projection's accuracy of 1e-6 each are an error of
/// 1.7e-6, in a handle's position and in its rotation, which moves the object's origin as much again a metre from the handle.
const PER_CHANGE: f64 = 4e-6;

/// What an object is attached to, and where it was when that began.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Attached {
    carrier: Option<usize>,
    /// The body of the object that is held.
    held: usize,
    carrier_from_held: Pose,
}

/// What is known from the segments before.
pub(crate) struct Drift {
    /// By part: an object's carrier; none while it is held without one.
    attached: Vec<Option<Attached>>,
    /// By part: all steps, metres or radians, and what they may be.
    steps: Vec<(f64, f64)>,
    /// By body: where a joint was when it was last held.
    resting: Vec<Option<f64>>,
}

impl Drift {
    pub(crate) fn new(parts: usize, bodies: usize) -> Self {
        Self { attached: vec![None; parts], steps: vec![(0.0, BOTH_ENDS); parts], resting: vec![None; bodies] }
    }

    /// Adds a segment.
    pub(crate) fn add(&mut self, motion: &SegmentMotion<'_>, file: &PathFile, report: &mut CheckReport) {
        // Written so that a tolerance that is not a number is none.
        let tolerance = TOLERANCE.min(file.certificate.path_tolerance);
        let mut here = vec![None; self.attached.len()];
        for carry in &motion.carries {
            let Some((held, carrier)) = carrier_of(motion, carry.part) else { continue };
            let pose = |knot| motion.written(carrier, knot).inverse() * motion.written(Some(held), knot);
            let (first, last) = (pose(0), pose(motion.last()));
            let before =
                self.attached[carry.part].filter(|attached| (attached.carrier, attached.held) == (carrier, held));
            let origin = before.map_or(first, |attached| attached.carrier_from_held);
            let step = off(&first, &last);
            if step > tolerance {
                continue; // told of the segment itself
            }
            self.step(carry.part, before.is_none(), step);
            here[carry.part] = Some(Attached { carrier, held, carrier_from_held: origin });
            let name = &motion.world.parts[carry.part].name;
            let place = Place::at(motion.index, motion.last() as f64);
            let apart = off(&origin, &last);
            // Compared so that NaN drifts.
            let stays = apart <= tolerance;
            if !stays {
                let subject = format!("{name} has moved on what carries it since it came there");
                report.violate(place, Kind::Drift, subject, apart, tolerance);
            }
            let (sum, most) = self.steps[carry.part];
            let within = sum <= most;
            if !within {
                report.violate(place, Kind::Drift, format!("{name}: all its steps together"), sum, most);
            }
        }
        self.attached = here;
        self.joints(motion, tolerance, report);
    }

    fn step(&mut self, part: usize, changed: bool, amount: f64) {
        let (sum, most) = &mut self.steps[part];
        *sum += amount;
        *most += if changed { PER_CHANGE } else { 0.0 };
    }

    fn joints(&mut self, motion: &SegmentMotion<'_>, tolerance: f64, report: &mut CheckReport) {
        let world = motion.world;
        for joint in joints_of_objects(world) {
            if held_beyond(motion, joint) {
                self.resting[joint] = None;
                continue;
            }
            let [first, last] = [0, motion.last()].map(|knot| motion.scalar(joint, At::knot(knot)));
            if (last - first).abs() > tolerance {
                self.resting[joint] = None; // told of the segment itself
                continue;
            }
            let origin = *self.resting[joint].get_or_insert(first);
            let moved = (last - origin).abs();
            // Compared so that NaN drifts.
            let still = moved <= tolerance;
            if !still {
                let place = Place::at(motion.index, motion.last() as f64);
                let subject = format!("{} has moved since it was let go", world.bodies[joint].name);
                report.violate(place, Kind::Drift, subject, moved, tolerance);
            }
        }
    }
}

/// The body of an object that is held in a segment, and what carries it; none for the world and what stands in it.
fn carrier_of(motion: &SegmentMotion<'_>, part: usize) -> Option<(usize, Option<usize>)> {
    let (world, own) = (motion.world, motion.world.parts[part].bodies.clone());
    // The attachment may be at a link beyond joints of the object: it is the edge that leaves the part.
    let leaves = |body: &usize| motion.edges[*body].parent.is_none_or(|parent| !own.contains(&parent));
    let held = own.clone().find(|body| matches!(motion.edges[*body].via, Via::Rigid(_)) && leaves(body))?;
    let moves = |body: &usize| world.parts[world.bodies[*body].part].kind != PartKind::Environment;
    Some((held, motion.edges[held].parent.filter(moves)))
}

/// Shift or turn between two poses, whichever is more; metres and radians.
fn off(a: &Pose, b: &Pose) -> f64 {
    let b_rotation = if a.rotation.dot(b.rotation) < 0.0 { -b.rotation } else { b.rotation };
    let turn = 2.0 * crate::check::motion::segment::half_angle(a.rotation, b_rotation);
    let shift = a.translation.distance(b.translation);
    // Written so that NaN stays one.
    if turn > shift { turn } else { shift + 0.0 * turn }
}
