//! From a robot's collision shapes to what queries want of them.

use crate::collision::scene::bounding::BoundingVolume;
use crate::collision::scene::inscribed::InscribedVolume;
use crate::collision::solids::mesh_tree::MeshTree;
use crate::collision::solids::solid::Solid;
use crate::collision::solids::volumes::{Ball, Capsule};
use foliate_components::Pose;
use foliate_components::robot::shape::{Geometry, Mesh};
use foliate_components::robot::{JointIndex, LinkIndex, Robot, Shape};
use std::sync::Arc;

/// A collision shape as queries want it.
#[derive(Clone, Debug)]
pub struct SceneSolid {
    /// Its body; `None` where it is fixed to the world.
    pub body: Option<JointIndex>,
    /// Its link.
    pub link: LinkIndex,
    /// Its pose in its body's joint frame, or in the world.
    pub X_JS: Pose,
    /// The solid.
    pub solid: Solid,
    /// A ball that holds it, in the body's joint frame or in the world.
    pub ball: Ball,
    /// A capsule that holds it, in the body's joint frame or in the world.
    pub capsule: Capsule,
    /// Which cluster it belongs to.
    pub cluster: u32,
    /// What bounds in lanes know of it.
    pub(crate) bounding: BoundingVolume,
    /// What lies inside of it with certainty.
    pub(crate) inscribed: Option<InscribedVolume>,
}

/// Solids of shapes; a mesh that many share has one tree.
pub(crate) struct Solids<'a> {
    meshes: Vec<(Arc<Mesh>, Solid)>,
    go_on: &'a dyn Fn() -> bool,
}

impl<'a> Solids<'a> {
    /// None yet. Once `go_on` says no there are no more.
    pub(crate) fn new(go_on: &'a dyn Fn() -> bool) -> Self {
        Self { meshes: Vec::new(), go_on }
    }

    pub(crate) fn of(&mut self, geometry: &Geometry) -> Option<Solid> {
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
    pub(crate) fn new(robot: &Robot, shape: &Shape, solid: Solid) -> Self {
        let X_JS = shape.joint_from_shape;
        let ball = Ball::of(&solid);
        Self {
            body: robot.links[shape.link.at()].joint,
            link: shape.link,
            X_JS,
            ball: Ball { center: X_JS.transform_point(ball.center), radius: ball.radius },
            capsule: Capsule::of(&solid).moved(&X_JS),
            bounding: BoundingVolume::of(&solid, &X_JS),
            inscribed: InscribedVolume::of(&solid, &X_JS),
            solid,
            cluster: 0,
        }
    }
}
