//! Clearance of two solids: "at least d?", and if not, how much.
//!
//! [`clearance`] is a lower bound of the distance that is either at least what was asked for or nearly exact
//! (DESIGN §5.5: *in doubt, in collision*). Pairs of round solids and of a ball with anything use closed forms; the rest
//! goes to GJK (gjk.rs), meshes to their tree (mesh_distance.rs). We wrote our own GJK instead of calling
//! parry's because its result carries a proof (the separating slab), and because a query "at least d?" may then end after
//! one support; parry remains what it is tested against.

use super::convex::{Convex, Core};
pub use super::gjk::Ask;
use super::gjk::{ROUNDING, Relative, core_distance};
use super::mesh_distance::{mesh_convex_distance, mesh_mesh_distance};
use super::mesh_tree::MeshTree;
use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use glam::DVec3;
use std::sync::Arc;

/// A collision solid, ready for distance queries.
#[derive(Clone, Debug)]
pub enum Solid {
    /// A convex one.
    Convex(Convex),
    /// A triangle mesh; closed ones are solid, but only [`super::verdict`] knows that: distances are to the surface.
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

/// A lower bound of the distance between two solids, metres: at least `ask.needed`, or within `ask`'s tolerances of the
/// distance. Not positive where they (may) overlap, and −∞ where a number is not finite.
///
/// `X_WA` and `X_WB` are the solids' poses in one frame. `hint` remembers a separating direction in that frame from one
/// call for the pair to the next; start with zero. For two convex solids it is afterwards the unit vector from `b` to `a`
/// along which they are at least as far apart as the result says; with meshes it is one that set some triangles apart.
/// Results depend on the hint only within the tolerances.
#[must_use]
pub fn clearance(a: &Solid, X_WA: &Pose, b: &Solid, X_WB: &Pose, ask: Ask, hint: &mut DVec3) -> f64 {
    // Infinite coordinates would give NaN differences further on: stop both at the gate.
    if !(X_WA.translation.is_finite()
        && X_WB.translation.is_finite()
        && X_WA.rotation.is_finite()
        && X_WB.rotation.is_finite())
    {
        return f64::NEG_INFINITY;
    }
    let found = match (a, b) {
        (Solid::Convex(a), Solid::Convex(b)) => convex_clearance(a, X_WA, b, X_WB, ask, hint),
        (Solid::Mesh(mesh), Solid::Convex(convex)) => {
            let mut local = X_WA.rotation.conjugate() * *hint;
            let found = mesh_convex_distance(mesh, convex, &Relative::between(X_WA, X_WB), ask, &mut local);
            *hint = X_WA.rotation * local;
            found
        }
        (Solid::Convex(convex), Solid::Mesh(mesh)) => {
            let mut local = X_WB.rotation.conjugate() * -*hint;
            let found = mesh_convex_distance(mesh, convex, &Relative::between(X_WB, X_WA), ask, &mut local);
            *hint = -(X_WB.rotation * local);
            found
        }
        (Solid::Mesh(a), Solid::Mesh(b)) => {
            let mut local = X_WA.rotation.conjugate() * *hint;
            let found = mesh_mesh_distance(a, b, &Relative::between(X_WA, X_WB), ask, &mut local);
            *hint = X_WA.rotation * local;
            found
        }
    };
    if found.is_nan() { f64::NEG_INFINITY } else { found }
}

fn convex_clearance(a: &Convex, X_WA: &Pose, b: &Convex, X_WB: &Pose, ask: Ask, hint: &mut DVec3) -> f64 {
    let radii = a.radius + b.radius;
    let apart = match (a.core, b.core) {
        // Covers every pair with a ball: the closest point of a core to a point has a closed form.
        (Core::Point, other) => X_WA.translation - closest_in_world(&other, X_WB, X_WA.translation),
        (other, Core::Point) => closest_in_world(&other, X_WA, X_WB.translation) - X_WB.translation,
        (Core::Segment { half_length: h }, Core::Segment { half_length: k }) => {
            let (u, v) = (X_WA.rotation * DVec3::Z * h, X_WB.rotation * DVec3::Z * k);
            between_segments(X_WA.translation, u, X_WB.translation, v)
        }
        (first, second) => {
            let X_AB = Relative::between(X_WA, X_WB);
            let mut local = X_WA.rotation.conjugate() * *hint;
            let distance = core_distance(&first, &second, &X_AB, radii, ask, &mut local);
            *hint = X_WA.rotation * local;
            return distance;
        }
    };
    let distance = apart.length();
    *hint = if distance > 0.0 { apart / distance } else { DVec3::ZERO };
    distance - radii - ROUNDING
}

fn closest_in_world(core: &Core, X_WC: &Pose, point: DVec3) -> DVec3 {
    X_WC.transform_point(core.closest_to(X_WC.inverse_transform_point(point)))
}

/// The shortest vector from the second of two segments to the first, each given by its middle and half of its direction.
#[inline]
#[must_use]
pub(super) fn between_segments(p: DVec3, u: DVec3, q: DVec3, v: DVec3) -> DVec3 {
    let r = p - q;
    let (uu, vv, uv, ur, vr) = (u.dot(u), v.dot(v), u.dot(v), u.dot(r), v.dot(r));
    let unit = |x: f64| x.clamp(-1.0, 1.0);
    let along = |numerator: f64, square: f64| if square > 0.0 { unit(numerator / square) } else { 0.0 };
    // Minimise |r + s·u − t·v|² over the square [−1, 1]²: the free minimum in s, then t for it, then s for that t. For
    // parallel segments the first choice is arbitrary and the next two still end in a minimum of a convex function only
    // if they clamp the right end, so both ends of s are tried there.
    let determinant = uu * vv - uv * uv;
    let value = |s: f64| {
        let t = along(uv * s + vr, vv);
        let s = along(uv * t - ur, uu);
        r + u * s - v * t
    };
    if determinant > 1e-12 * uu * vv {
        value(unit((uv * vr - vv * ur) / determinant))
    } else {
        let shorter = |a: DVec3, b: DVec3| if b.length_squared() < a.length_squared() { b } else { a };
        shorter(shorter(value(-1.0), value(1.0)), value(0.0))
    }
}
