//! A collision solid: a convex one, or a triangle mesh.
//!
//! `Solid` is made of the geometry of a shape. Its bounding ball, bounding capsule and farthest point are here too, because they
//! need both kinds of solid; `volumes` defines the bounding volumes themselves.

use crate::collision::convex::core::{Convex, Core};
use crate::collision::solids::mesh_tree::MeshTree;
use crate::collision::solids::volumes::{Ball, Capsule, SLACK, farthest_of};
use foliate_components::robot::shape::Geometry;
use glam::DVec3;
use std::sync::Arc;

impl Ball {
    /// The ball of a solid, in the solid's frame.
    #[must_use]
    pub fn of(solid: &Solid) -> Self {
        match solid {
            // The primitives are symmetric about their origin.
            Solid::Convex(convex) => {
                let core = convex.core.farthest_from(DVec3::ZERO).length();
                Self { center: DVec3::ZERO, radius: (core + convex.radius) * SLACK }
            }
            Solid::Mesh(mesh) => mesh.bounding.ball,
        }
    }
}

impl Capsule {
    /// A capsule of a solid along its longest axis, in the solid's frame.
    #[must_use]
    pub fn of(solid: &Solid) -> Self {
        match solid {
            Solid::Convex(Convex { core, radius }) => match *core {
                Core::Segment { half_length } => Self::along_z(half_length, *radius),
                Core::Cylinder { radius: r, half_length } => Self::along_z(half_length, r * SLACK + radius),
                Core::Box { half_extents } => {
                    Self::of_points(DVec3::ZERO, half_extents, &corners(half_extents), *radius)
                }
                Core::Point | Core::Triangle(_) => {
                    let ball = Ball::of(solid);
                    Self { middle: ball.center, half: DVec3::ZERO, radius: ball.radius }
                }
            },
            Solid::Mesh(mesh) => mesh.bounding.capsule,
        }
    }
}

/// The point of a solid farthest from `from`, in the solid's frame. For round solids and cylinders near their axis it is
/// one of many.
pub(crate) fn farthest(solid: &Solid, from: DVec3) -> DVec3 {
    match solid {
        Solid::Convex(convex) => {
            let core = convex.core.farthest_from(from);
            core + (core - from).normalize_or(DVec3::X) * convex.radius
        }
        Solid::Mesh(mesh) => farthest_of(mesh.triangles.as_flattened(), from),
    }
}

fn corners(h: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        h * DVec3::new(sign(0), sign(1), sign(2))
    })
}

/// A collision solid, ready for distance queries.
#[derive(Clone, Debug)]
pub enum Solid {
    /// A convex one.
    Convex(Convex),
    /// A triangle mesh; closed ones are solid, but only [`crate::collision::discrete::one`] knows that: distances are to the surface.
    Mesh(Arc<MeshTree>),
}

impl Solid {
    /// The solid of a geometry, in the same frame.
    #[must_use]
    pub fn of(geometry: &Geometry) -> Self {
        match geometry {
            Geometry::Sphere { radius } => Self::Convex(Convex { core: Core::Point, radius: *radius }),
            Geometry::Box { half_extents } => {
                Self::Convex(Convex { core: Core::Box { half_extents: *half_extents }, radius: 0.0 })
            }
            Geometry::Cylinder { radius, half_length } => Self::Convex(Convex {
                core: Core::Cylinder { radius: *radius, half_length: *half_length },
                radius: 0.0,
            }),
            Geometry::Capsule { radius, half_length } => {
                Self::Convex(Convex { core: Core::Segment { half_length: *half_length }, radius: *radius })
            }
            Geometry::Mesh(mesh) => Self::Mesh(Arc::new(MeshTree::new(mesh))),
        }
    }
}
