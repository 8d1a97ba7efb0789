//! What takes long to find out about a mesh, and the proof that something found earlier holds.
//!
//! A [`MeshRecord`] lets a tree be built without the search for medians, extreme points and searches over the hull. Where it comes from is
//! not known here, so that nothing of it is believed: boxes are computed from the triangles in whatever order they have, and how far a
//! vertex is beyond the hull from the few points that it is said to be near. A record that does not hold is left aside.

use crate::collision::solids::boxes::{Extent, corners_of};
use crate::collision::solids::hull::{FoundHull, MOST_POINTS, is_around};
use crate::collision::solids::support_points::PointRows;
use crate::collision::solids::triangle_order::triangle_order;
use foliate_components::robot::shape::Mesh;
use foliate_components::robot::shape::mesh_record::MeshRecord;
use foliate_components::robot::shape::positions::first_at_position;
use glam::DVec3;

/// What there is to be known of a mesh, found from nothing; none where the mesh has no triangles, an index out of range or a
/// coordinate that is not finite, and nothing could be proved of it. The result [holds](proves).
#[must_use]
pub fn record(mesh: &Mesh) -> Option<MeshRecord> {
    record_while(mesh, &|| true)
}

/// As [`record`]; none too once `go_on` says no.
#[must_use]
pub fn record_while(mesh: &Mesh, go_on: &dyn Fn() -> bool) -> Option<MeshRecord> {
    findings(mesh, go_on).filter(|record| go_on() && proves(mesh, record))
}

/// Whether a tree may be built from a record: all that an answer depends on is computed anew from the mesh. Costs a tenth of finding
/// it.
#[must_use]
pub fn proves(mesh: &Mesh, record: &MeshRecord) -> bool {
    let in_range = |i: &u32| (*i as usize) < mesh.vertices.len();
    let point = |i: &u32| mesh.vertices.get(*i as usize).copied();
    let points: Option<Vec<DVec3>> = record.hull.iter().map(point).collect();
    !mesh.triangles.is_empty()
        && mesh.triangles.as_flattened().iter().all(in_range)
        && mesh.vertices.iter().all(|v| v.is_finite())
        && (1..=MOST_POINTS).contains(&record.hull.len())
        && is_permutation(&record.order, mesh.triangles.len())
        && are_at_one_position(&record.same, &mesh.vertices)
        && points.is_some_and(|points| is_around(&points, &mesh.vertices, &record.near, record.slack))
}

/// What a tree is built from where there is no record that holds. Nothing is refused here; of meshes that are not as they should be
/// little is found. None once `go_on` says no.
pub(crate) fn findings(mesh: &Mesh, go_on: &dyn Fn() -> bool) -> Option<MeshRecord> {
    let goes_on = || go_on().then_some(());
    goes_on()?;
    let corners = corners_of(mesh);
    let triangles: Vec<[DVec3; 3]> = (0..mesh.triangles.len()).map(corners).collect();
    // Around numbers that are none, or too large for a box, there is nothing.
    let extent = Extent::of_all(triangles.iter().map(Extent::of));
    let hull = match !triangles.is_empty() && extent.bounds().half.is_finite() {
        true => FoundHull::of(&mesh.vertices, extreme_points(&mesh.vertices)),
        false => FoundHull::default(),
    };
    goes_on()?;
    let mut same = first_at_position(&mesh.vertices);
    if same.iter().enumerate().all(|(i, &first)| i == first as usize) {
        same.clear();
    }
    goes_on()?;
    let order = triangle_order(&triangles, go_on)?;
    Some(MeshRecord { same, order, hull: hull.points, near: hull.near, slack: hull.slack })
}

/// Whether every number below `count` is there, once.
fn is_permutation(order: &[u32], count: usize) -> bool {
    let mut seen = vec![false; count];
    let is_new = |i: &u32| seen.get_mut(*i as usize).is_some_and(|seen| !std::mem::replace(seen, true));
    order.len() == count && order.iter().all(is_new)
}

/// Whether vertices that are said to be at one position are. Others may be too, which only makes connected pieces larger: then a
/// witness is asked for more than once.
fn are_at_one_position(same: &[u32], vertices: &[DVec3]) -> bool {
    let holds = |(i, &first): (usize, &u32)| first as usize <= i && vertices[first as usize] == vertices[i];
    same.is_empty() || (same.len() == vertices.len() && same.iter().enumerate().all(holds))
}

/// The vertices that lie farthest in each of 98 directions.
fn extreme_points(vertices: &[DVec3]) -> Vec<u32> {
    let rows = PointRows::of(vertices);
    let range = || -2..=2_i32;
    let directions = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| (x, y, z))));
    directions
        .filter(|&(x, y, z)| x.abs().max(y.abs()).max(z.abs()) == 2)
        .map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z)))
        .filter_map(|d| rows.as_ref().and_then(|rows| rows.last_along(d)).or_else(|| last_along(vertices, d)))
        .map(|number| number as u32)
        .collect()
}

/// One after another: of zeros of both signs the positive one is larger.
fn last_along(vertices: &[DVec3], d: DVec3) -> Option<usize> {
    (0..vertices.len()).max_by(|&a, &b| vertices[a].dot(d).total_cmp(&vertices[b].dot(d)))
}
