//! Clearance of two solids: "at least d?", and if not, how much.
//!
//! [`clearance`] is a lower bound of the distance that is either at least what was asked for or nearly exact
//! (*in doubt, in collision*). Pairs of round solids and of a ball with anything use closed forms; the rest
//! goes to GJK (`convex/gjk.rs`), meshes to their tree (`mesh_distance.rs`). We wrote our own GJK instead of calling
//! parry's because its result carries a proof (the separating slab), and because a query "at least d?" may then end after
//! one support; parry remains what it is tested against.

use crate::collision::convex::core::{Convex, Core};
pub use crate::collision::convex::gjk::DistanceQuery;
use crate::collision::convex::gjk::{ROUNDING, Relative, core_distance};
use crate::collision::convex::segments::between_segments;
use crate::collision::distance::mesh_distance::{mesh_convex_distance, mesh_mesh_distance};
use crate::collision::solids::solid::Solid;
use foliate_components::Pose;
use glam::DVec3;

/// A lower bound of the distance between two solids, metres: at least `query.needed`, or within `query`'s tolerances of the
/// distance. Not positive where they (may) overlap, and −∞ where a number is not finite.
///
/// `X_WA` and `X_WB` are the solids' poses in one frame. `hint` remembers a separating direction in that frame from one
/// call for the pair to the next; start with zero. For two convex solids it is afterwards the unit vector from `b` to `a`
/// along which they are at least as far apart as the result says; with meshes it is one that set some triangles apart.
/// Results depend on the hint only within the tolerances.
#[must_use]
pub fn clearance(a: &Solid, X_WA: &Pose, b: &Solid, X_WB: &Pose, query: DistanceQuery, hint: &mut DVec3) -> f64 {
    // Infinite coordinates would give NaN differences further on: stop both at the gate.
    if !(X_WA.translation.is_finite()
        && X_WB.translation.is_finite()
        && X_WA.rotation.is_finite()
        && X_WB.rotation.is_finite())
    {
        return f64::NEG_INFINITY;
    }
    let found = match (a, b) {
        (Solid::Convex(a), Solid::Convex(b)) => convex_clearance(a, X_WA, b, X_WB, query, hint),
        (Solid::Mesh(mesh), Solid::Convex(convex)) => {
            let mut local = X_WA.rotation.conjugate() * *hint;
            let found = mesh_convex_distance(mesh, convex, &Relative::between(X_WA, X_WB), query, &mut local);
            *hint = X_WA.rotation * local;
            found
        }
        (Solid::Convex(convex), Solid::Mesh(mesh)) => {
            let mut local = X_WB.rotation.conjugate() * -*hint;
            let found = mesh_convex_distance(mesh, convex, &Relative::between(X_WB, X_WA), query, &mut local);
            *hint = -(X_WB.rotation * local);
            found
        }
        (Solid::Mesh(a), Solid::Mesh(b)) => {
            let mut local = X_WA.rotation.conjugate() * *hint;
            let found = mesh_mesh_distance(a, b, &Relative::between(X_WA, X_WB), query, &mut local);
            *hint = X_WA.rotation * local;
            found
        }
    };
    if found.is_nan() { f64::NEG_INFINITY } else { found }
}

fn convex_clearance(a: &Convex, X_WA: &Pose, b: &Convex, X_WB: &Pose, query: DistanceQuery, hint: &mut DVec3) -> f64 {
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
            let distance = core_distance(&first, &second, &X_AB, radii, query, &mut local);
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
