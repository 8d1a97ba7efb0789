//! From a robot's collision shapes to what queries want of them.

use super::bounds::{Ball, Capsule};
use super::distance::Solid;
use super::inner::Inner;
use super::mesh_tree::MeshTree;
use super::outer::Outer;
use super::scene::SceneSolid;
use foliate_components::robot::shape::{Geometry, Mesh};
use foliate_components::robot::{Robot, Shape};
use std::sync::Arc;

/// Solids of shapes; a mesh that many share has one tree.
pub(super) struct Solids<'a> {
    meshes: Vec<(Arc<Mesh>, Solid)>,
    go_on: &'a dyn Fn() -> bool,
}

impl<'a> Solids<'a> {
    /// None yet. Once `go_on` says no there are no more.
    pub(super) fn new(go_on: &'a dyn Fn() -> bool) -> Self {
        Self { meshes: Vec::new(), go_on }
    }

    pub(super) fn of(&mut self, geometry: &Geometry) -> Option<Solid> {
        let Geometry::Mesh(mesh) = geometry else { return Some(Solid::of(geometry)) };
        if let Some((_, solid)) = self.meshes.iter().find(|(known, _)| Arc::ptr_eq(known, mesh)) {
            return Some(solid.clone());
        }
        let solid = Solid::Mesh(Arc::new(MeshTree::new_while(mesh, self.go_on)?));
        self.meshes.push((mesh.clone(), solid.clone()));
        Some(solid)
    }
}

impl SceneSolid {
    pub(super) fn new(robot: &Robot, shape: &Shape, solid: Solid) -> Self {
        let X_JS = shape.joint_from_shape;
        let ball = Ball::of(&solid);
        Self {
            body: robot.links[shape.link.at()].joint,
            link: shape.link,
            X_JS,
            ball: Ball { center: X_JS.transform_point(ball.center), radius: ball.radius },
            capsule: Capsule::of(&solid).moved(&X_JS),
            outer: Outer::of(&solid, &X_JS),
            inner: Inner::of(&solid, &X_JS),
            solid,
            cluster: 0,
        }
    }
}
