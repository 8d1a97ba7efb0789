//! Ball and capsule around a mesh: found once, for every shape that the mesh has.

use super::bounds::{Ball, Capsule, farthest_of};
use super::mesh_tree::MeshTree;
use super::point_rows::PointRows;
use foliate_components::robot::shape::Mesh;
use glam::DVec3;

/// What holds a mesh, in its frame. Metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    pub ball: Ball,
    /// Along its longest side.
    pub capsule: Capsule,
    /// Radius of a ball about the middle of its box.
    pub about_middle: f64,
}

impl Default for Around {
    fn default() -> Self {
        let nothing = Ball { center: DVec3::ZERO, radius: 0.0 };
        let capsule = Capsule { middle: DVec3::ZERO, half: DVec3::ZERO, radius: 0.0 };
        Self { ball: nothing, capsule, about_middle: 0.0 }
    }
}

impl Around {
    /// Around the triangles of a tree whose boxes and hull are there; they are those of `mesh`.
    pub(super) fn of(mesh: &Mesh, tree: &MeshTree) -> Self {
        let (middle, half) = tree.bounds().map_or((DVec3::ZERO, DVec3::ZERO), |b| (b.center, b.half));
        let center = Ball::center_of_few(&tree.hull.points, middle);
        let points = tree.triangles.as_flattened();
        // Vertices are a sixth of the corners of triangles.
        let rows = match is_all_used(mesh) {
            true => PointRows::of(&mesh.vertices),
            false => PointRows::of(points),
        };
        match rows {
            Some(rows) => Self {
                ball: Ball::reaching(center, rows.last_from(center).1.sqrt()),
                capsule: rows.capsule(middle, half),
                about_middle: rows.last_from(middle).1.sqrt(),
            },
            None => Self {
                ball: Ball::reaching(center, farthest_of(points, center).distance(center)),
                capsule: Capsule::of_points(middle, half, points, 0.0),
                about_middle: farthest_of(points, middle).distance(middle),
            },
        }
    }
}

/// Whether the corners of the triangles are the vertices, all there and none to spare.
fn is_all_used(mesh: &Mesh) -> bool {
    let mut used = vec![false; mesh.vertices.len()];
    for &corner in mesh.triangles.as_flattened() {
        match used.get_mut(corner as usize) {
            Some(used) => *used = true,
            None => return false,
        }
    }
    used.into_iter().all(|used| used)
}
