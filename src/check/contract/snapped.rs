//! An object that the scene has a little off its support, and the path on it: a planner may move it there.
//!
//! That is allowed along the normal of the support and by a small tilt, not along the support, and only of an object that lies on
//! a surface and that no gripper holds. That the path has it on its support is proved elsewhere (`leaf`).

use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::world::attachments::Bond;
use crate::check::world::models::{Link, corners, normal};
use crate::path_file::document::PathFile;
use foliate_components::Pose;
use glam::DVec3;

/// Most that a corner of the polygon that touches may be moved, metres.
const FARTHEST: f64 = 1e-3 + 1e-6;
/// Most that the object may be tilted, radians.
const MOST_TILT: f64 = 1e-2 + 1e-6;
/// Most that the middle of the polygon may go along the support, metres.
const ALONG: f64 = 1e-5;
/// Most that the object may turn about the normal, radians: half the square of the tilt.
const TURN: f64 = 1e-4;

/// Whether an object's root, which a knot of the motion has at `found` and the scene at `wanted`, was only moved onto its support:
/// by how much the farthest corner was, metres.
pub(super) fn onto_support(
    file: &PathFile,
    motion: &SegmentMotion<'_>,
    at: At,
    part: &str,
    [found, wanted]: [&Pose; 2],
) -> Option<f64> {
    let part = motion.world.part(part)?;
    let mut of_object = motion.attachments.iter().filter(|attachment| attachment.part == part);
    if of_object.clone().any(|attachment| attachment.is_grasp()) {
        return None;
    }
    of_object.find_map(|attachment| {
        let (holder, held, Bond::Contact { surface, support }) = attachment.held.as_ref()? else { return None };
        let surfaces = &file.documents.surfaces;
        let (surface, support) = (surfaces.get(surface)?, surfaces.get(support)?);
        let ups = support.polygons.iter().filter_map(|polygon| normal(&corners(support, polygon)));
        let ups: Vec<DVec3> = ups.map(|up| motion.frame(&holder.frame, at).rotation * up).collect();
        let polygons = surface.polygons.iter().map(|polygon| corners(surface, polygon));
        let moved =
            polygons.flat_map(|polygon| ups.iter().filter_map(move |up| moved(&polygon, held, *up, [found, wanted])));
        moved.reduce(f64::min)
    })
}

/// How far the farthest corner of a polygon of the link `held` was moved along the normal `up`; none where it was moved otherwise.
fn moved(polygon: &[DVec3], held: &Link, up: DVec3, [found, wanted]: [&Pose; 2]) -> Option<f64> {
    let shift = |point: DVec3| {
        let on_body = held.frame.body_from_frame.transform_point(point);
        found.transform_point(on_body) - wanted.transform_point(on_body)
    };
    let turned = found.rotation * wanted.rotation.conjugate();
    let tilt = if turned.w < 0.0 { (-turned).to_scaled_axis() } else { turned.to_scaled_axis() };
    let middle = shift(polygon.iter().sum::<DVec3>() / polygon.len() as f64);
    let farthest = polygon.iter().map(|corner| shift(*corner).length()).fold(0.0, f64::max);
    // Compared so that NaN is refused.
    let allowed = farthest <= FARTHEST
        && tilt.length() <= MOST_TILT
        && tilt.dot(up).abs() <= TURN
        && (middle - middle.dot(up) * up).length() <= ALONG;
    allowed.then_some(farthest)
}
