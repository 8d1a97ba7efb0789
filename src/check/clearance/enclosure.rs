//! Whether a solid starts inside a closed mesh: distances are to surfaces, which see meshes as hollow.
//!
//! What starts outside and never touches the surface stays outside, so the first knot of a segment suffices. A point is
//! inside where the mesh winds round it: the sum of the solid angles of its triangles is 4π (A. Van Oosterom, J.
//! Strackee, The solid angle of a plane triangle, IEEE Trans. Biomed. Eng. 30, 1983).

use foliate_components::Pose;
use foliate_components::robot::shape::{Geometry, Mesh};
use glam::DVec3;

/// A closed mesh and the box around it.
pub(crate) struct Shell<'m> {
    mesh: &'m Mesh,
    low: DVec3,
    high: DVec3,
}

impl<'m> Shell<'m> {
    /// The shell of a shape; none for what is no closed mesh.
    pub(crate) fn of(geometry: &'m Geometry) -> Option<Self> {
        let Geometry::Mesh(mesh) = geometry else { return None };
        let low = mesh.vertices.iter().copied().reduce(DVec3::min)?;
        let high = mesh.vertices.iter().copied().reduce(DVec3::max)?;
        mesh.closed.then_some(Self { mesh, low, high })
    }

    /// Whether a point, in the mesh's frame, is inside.
    pub(crate) fn contains(&self, point: DVec3) -> bool {
        let in_box = point.cmpge(self.low).all() && point.cmple(self.high).all();
        in_box && winding(self.mesh, point).abs() > 0.5
    }
}

/// Whether a shape whose surface does not touch the other's lies inside that: only closed meshes have an inside.
pub(crate) fn is_inside(inner: &Geometry, outer: &Geometry, outer_from_inner: &Pose) -> bool {
    let inside =
        |shell: Shell<'_>| witnesses(inner).iter().any(|&p| shell.contains(outer_from_inner.transform_point(p)));
    Shell::of(outer).is_some_and(inside)
}

fn winding(mesh: &Mesh, point: DVec3) -> f64 {
    let solid_angle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.vertices[i as usize] - point);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    mesh.triangles.iter().map(solid_angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// Points of which one is inside a shell if the shape is, and its surface touches none: one per connected piece.
pub(crate) fn witnesses(geometry: &Geometry) -> Vec<DVec3> {
    let Geometry::Mesh(mesh) = geometry else { return vec![DVec3::ZERO] };
    let mut leader: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    for &[a, b, c] in &mesh.triangles {
        for (x, y) in [(a, b), (b, c)] {
            let (x, y) = (root(&mut leader, x), root(&mut leader, y));
            leader[x.max(y) as usize] = x.min(y);
        }
    }
    let mut used = vec![false; mesh.vertices.len()];
    mesh.triangles.iter().for_each(|t| used[root(&mut leader, t[0]) as usize] = true);
    mesh.vertices.iter().zip(used).filter(|(_, used)| *used).map(|(v, _)| *v).collect()
}

fn root(leader: &mut [u32], mut vertex: u32) -> u32 {
    while leader[vertex as usize] != vertex {
        leader[vertex as usize] = leader[leader[vertex as usize] as usize];
        vertex = leader[vertex as usize];
    }
    vertex
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn tetrahedron() -> Geometry {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        Geometry::Mesh(Arc::new(Mesh::new("here".into(), vertices, triangles)))
    }

    #[test]
    fn a_closed_mesh_winds_once_round_its_inside() {
        let solid = tetrahedron();
        let shell = Shell::of(&solid).unwrap();
        assert!(shell.contains(DVec3::splat(0.1)));
        assert!(!shell.contains(DVec3::splat(0.5)), "in the box, beyond the slanted face");
        assert!(!shell.contains(DVec3::splat(2.0)));
        assert!((winding(shell.mesh, DVec3::splat(0.1)).abs() - 1.0).abs() < 1e-12);
        assert_eq!(witnesses(&solid).len(), 1);
    }

    #[test]
    fn an_open_mesh_has_no_inside() {
        let Geometry::Mesh(closed) = tetrahedron() else { panic!("a mesh") };
        let open = Mesh::new("here".into(), closed.vertices.clone(), closed.triangles[1..].to_vec());
        assert!(Shell::of(&Geometry::Mesh(Arc::new(open))).is_none());
    }
}
