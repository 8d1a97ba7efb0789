//! At every knot an object is written where its carrier takes it from the segment's first knot.

use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::kind::Kind;
use crate::path_file::document::PathFile;

/// How far a written object may be from where its carrier takes it, metres and radians.
const TOLERANCE: f64 = 1e-5;

pub(crate) fn check(motion: &SegmentMotion<'_>, file: &PathFile, report: &mut CheckReport) {
    // Written so that a tolerance that is not a number is none.
    let tolerance = TOLERANCE.min(file.certificate.path_tolerance);
    for carry in &motion.carries {
        let name = motion.name_of(carry);
        let kind = match carry.attachment.map(|a| motion.attachments[a].is_grasp()) {
            Some(true) => Kind::ObjectOffCarrier,
            Some(false) => Kind::PlacedObjectMoved,
            None => Kind::UnattachedObjectMoved,
        };
        if carry.attachment.is_none() {
            let object = &motion.world.parts[carry.part].name;
            report.note(format!("{object} has no attachment in some segments: it must rest there"));
        }
        let root = motion.world.parts[carry.part].root;
        for knot in 0..motion.knots.len() {
            let (written, carried) = (motion.written(root, knot), motion.pose(root, At::knot(knot)));
            let shift = written.translation.distance(carried.translation);
            let turn = angle(written.rotation, carried.rotation);
            for (what, error) in [("position", shift), ("orientation", turn)] {
                // Compared so that NaN is off.
                let on = error <= tolerance;
                if !on {
                    let place = Place::at(motion.index, knot as f64);
                    report.violate(place, kind, format!("{name}: {what}"), error, tolerance);
                }
                report.see_off_carrier(error, motion.index, knot as f64, || format!("{name}: {what}"));
            }
        }
    }
    for attachment in motion.attachments.iter().filter(|a| a.carrier && !motion.world.parts[a.part].floats) {
        let object = &motion.world.parts[attachment.part].name;
        let name = &attachment.name;
        report.note(format!("{name} carries {object}, which has no free-flying root: checked, not followed"));
    }
}

/// Angle between two rotations, radians, exact for small ones.
fn angle(a: glam::DQuat, b: glam::DQuat) -> f64 {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    2.0 * crate::check::motion::segment::half_angle(a, b)
}
