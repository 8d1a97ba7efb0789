//! Places where a tool holds an object by its tip: the middle of faces, and points of a surface above the centre of mass.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::handles::handle::{FoundHandle, HandleSettings, frame};
use crate::setup::objects::RigidObject;
use crate::setup::solids::surface_points::ray;
use foliate_components::robot::shape::Geometry;
use glam::DVec3;
use std::f64::consts::TAU;

/// How far the tip stays off the surface, metres.
const OFF: f64 = 1e-3;
/// How far before it the tool stands still, metres.
const CLEARANCE: f64 = 0.05;
/// Places around a cylinder.
const AROUND: usize = 8;
/// A face of a hull is flat where the surface below its middle is nearer than this, metres.
const FLAT: f64 = 1e-3;
/// Least area of a face, square metres.
const LEAST_AREA: f64 = 1e-4;

/// The places of an object: all faces of a box, the ends and sides of a cylinder, fourteen directions of a sphere; of any other object the
/// faces of its hull that lie on its surface.
pub(super) fn places(object: &RigidObject, settings: HandleSettings) -> Vec<FoundHandle> {
    let single = match object.shapes.as_slice() {
        [(X_LS, solid)] => on_primitive(solid)
            .map(|places| places.into_iter().map(|(p, n)| (X_LS.transform_point(p), X_LS.rotation * n)).collect()),
        _ => None,
    };
    let places: Vec<(DVec3, DVec3)> = single.unwrap_or_else(|| on_hull(object));
    let handle = |(at, (point, normal)): (usize, (DVec3, DVec3))| FoundHandle {
        name: format!("place_{}", at + 1),
        link_from_handle: frame(point + normal * OFF, -normal, normal.any_orthonormal_vector()),
        clearance: CLEARANCE,
        // The tool may turn about its approach.
        mask: [true, true, true, false, true, true],
        reason: "the tip of the tool on a face, free to turn about the approach".into(),
    };
    places.into_iter().take(settings.most).enumerate().map(handle).collect()
}

/// Points and normals on a primitive; none on a mesh.
fn on_primitive(solid: &Geometry) -> Option<Vec<(DVec3, DVec3)>> {
    let both = |axis: DVec3| [axis, -axis];
    Some(match solid {
        Geometry::Box { half_extents } => {
            [DVec3::Z, DVec3::X, DVec3::Y].into_iter().flat_map(both).map(|n| (n * *half_extents, n)).collect()
        }
        Geometry::Cylinder { radius, half_length } => {
            let around = (0..AROUND).map(|i| {
                let angle = TAU * i as f64 / AROUND as f64;
                let normal = DVec3::new(angle.cos(), angle.sin(), 0.0);
                (normal * *radius, normal)
            });
            both(DVec3::Z).map(|n| (n * *half_length, n)).into_iter().chain(around).collect()
        }
        Geometry::Sphere { radius } => {
            let corners = (0..8).map(|i| {
                let sign = |bit: i32| if i & bit == 0 { 1.0 } else { -1.0 };
                DVec3::new(sign(1), sign(2), sign(4)).normalize()
            });
            let axes = [DVec3::Z, DVec3::X, DVec3::Y].into_iter().flat_map(both);
            axes.chain(corners).map(|n| (n * *radius, n)).collect()
        }
        Geometry::Capsule { .. } | Geometry::Mesh(_) => return None,
    })
}

/// The faces of the hull that the surface fills where the tool would touch them: above the centre of mass, or in the middle.
fn on_hull(object: &RigidObject) -> Vec<(DVec3, DVec3)> {
    let mut found = Vec::new();
    for facet in object.hull.iter().filter(|facet| facet.area > LEAST_AREA) {
        let middle = facet.corners.iter().sum::<DVec3>() / facet.corners.len() as f64;
        let above = object.centre + facet.normal * (middle - object.centre).dot(facet.normal);
        let points = [above, middle].into_iter().filter(|p| facet.inside(*p) > 0.004);
        let is_filled = |p: &DVec3| {
            let hits = ray(&object.triangles, *p + facet.normal * FLAT, -facet.normal);
            hits.first().is_some_and(|hit| hit.0 < 2.0 * FLAT)
        };
        found.extend(points.into_iter().find(is_filled).map(|point| (point, facet.normal)));
    }
    found
}
