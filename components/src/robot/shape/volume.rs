//! Volumes of solids and their centres.

use crate::robot::shape::geometry::{Geometry, Mesh};
use glam::DVec3;
use std::f64::consts::PI;

impl Geometry {
    /// Volume in m³, and its centre in the shape's frame, metres. `None` for a mesh that is not closed, or that holds nothing.
    #[must_use]
    pub fn volume(&self) -> Option<(f64, DVec3)> {
        let about_origin = |volume: f64| Some((volume, DVec3::ZERO)).filter(|_| volume > 0.0);
        match self {
            Self::Sphere { radius } => about_origin(4.0 / 3.0 * PI * radius.powi(3)),
            Self::Box { half_extents } => about_origin(8.0 * half_extents.element_product()),
            Self::Cylinder { radius, half_length } => about_origin(2.0 * PI * radius * radius * half_length),
            Self::Capsule { radius, half_length } => {
                about_origin(2.0 * PI * radius * radius * half_length + 4.0 / 3.0 * PI * radius.powi(3))
            }
            Self::Mesh(mesh) => mesh_volume(mesh),
        }
    }
}

/// Sum of the tetrahedra between a vertex and the triangles (divergence theorem).
fn mesh_volume(mesh: &Mesh) -> Option<(f64, DVec3)> {
    let from = *mesh.vertices.first()?;
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|i| mesh.vertices[i as usize] - from);
        let six = a.dot(b.cross(c));
        volume += six / 6.0;
        moment += six / 24.0 * (a + b + c);
    }
    (mesh.closed && volume > 0.0).then(|| (volume, from + moment / volume))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn volumes_and_centres_are_those_of_the_solids() {
        let close = |found: Option<(f64, DVec3)>, volume: f64, centre: DVec3| {
            let (v, c) = found.unwrap();
            assert!((v - volume).abs() < 1e-12 && c.distance(centre) < 1e-12, "{v} {c}");
        };
        close(Geometry::Box { half_extents: DVec3::new(0.5, 1.0, 1.5) }.volume(), 6.0, DVec3::ZERO);
        close(Geometry::Capsule { radius: 1.0, half_length: 0.0 }.volume(), 4.0 / 3.0 * PI, DVec3::ZERO);
        // A tetrahedron: a sixth of its cube, its centre the mean of its corners.
        let at = DVec3::new(3.0, -2.0, 5.0);
        let vertices = vec![at, at + DVec3::X, at + DVec3::Y, at + DVec3::Z];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mesh = Mesh::new("tetrahedron".into(), vertices.clone(), triangles.clone());
        close(Geometry::Mesh(Arc::new(mesh)).volume(), 1.0 / 6.0, at + DVec3::splat(0.25));
        let open = Mesh::new("open".into(), vertices, triangles[1..].to_vec());
        assert_eq!(Geometry::Mesh(Arc::new(open)).volume(), None);
    }
}
