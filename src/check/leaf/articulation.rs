//! Joints of objects do not move by themselves: only while something beyond them is held.

use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::kind::Kind;
use crate::check::world::attachments::Bond;
use crate::check::world::models::World;
use crate::path_file::document::PathFile;
use foliate_components::robot::PartKind;

/// How far a joint that no gripper holds may be from where the segment's first knot has it, radians and metres.
const TOLERANCE: f64 = 1e-5;

pub(crate) fn check(motion: &SegmentMotion<'_>, file: &PathFile, report: &mut CheckReport) {
    let world = motion.world;
    // Written so that a tolerance that is not a number is none.
    let tolerance = TOLERANCE.min(file.certificate.path_tolerance);
    for joint in joints_of_objects(world).filter(|&j| !held_beyond(motion, j)) {
        let start = motion.scalar(joint, At::knot(0));
        for (knot, moved) in motion.farthest_from(joint, start).enumerate() {
            // Compared so that NaN is off.
            let still = moved <= tolerance;
            if !still {
                let place = Place::at(motion.index, knot as f64);
                report.violate(place, Kind::JointUnheld, &world.bodies[joint].name, moved, tolerance);
            }
        }
    }
}

/// Joints of one coordinate of objects, their roots aside.
pub(crate) fn joints_of_objects(world: &World) -> impl Iterator<Item = usize> {
    let objects = world.parts.iter().filter(|part| part.kind == PartKind::Object);
    let joints = objects.flat_map(|part| part.bodies.clone().filter(|&b| Some(b) != part.root));
    joints.filter(|&joint| world.bodies[joint].motion.configuration_size() == 1)
}

/// Whether a gripper holds a handle on the body of a joint, or on one further out.
pub(crate) fn held_beyond(motion: &SegmentMotion<'_>, joint: usize) -> bool {
    let handles = motion.attachments.iter().filter_map(|a| match &a.held {
        Some((_, held, Bond::Grasp { .. })) => held.frame.body,
        _ => None,
    });
    handles.into_iter().any(|body| {
        let mut next = Some(body);
        while let Some(at) = next.filter(|&at| at != joint) {
            next = motion.world.bodies[at].parent;
        }
        next == Some(joint)
    })
}
