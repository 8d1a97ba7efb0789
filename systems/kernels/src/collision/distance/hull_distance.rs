//! Distance of the convex hulls of two solids by GJK: a lower bound of the distance of the solids.
//!
//! It costs a few support evaluations, whereas `query` descends the trees of meshes. Callers ask it before the exact distance,
//! because hulls separate most pairs of links. The hulls themselves are built in `solids/hull.rs`.

use crate::collision::convex::gjk::{DistanceQuery, Relative, descend};
use crate::collision::solids::solid::Solid;
use foliate_components::Pose;
use glam::DVec3;

/// A lower bound of the distance of the hulls of two solids, metres: at least `query.needed`, or within `query`'s tolerances of the
/// hulls' distance; not positive where the hulls (may) overlap. Poses and `hint` as for
/// [`clearance`](crate::collision::distance::query::clearance): where the result is positive, `hint` is afterwards the unit
/// vector from `b` to `a` along which the solids are at least that far apart.
///
/// Negative infinity where a mesh has no triangles or numbers that are not finite: its hull says nothing.
#[must_use]
pub fn hull_distance(a: &Solid, X_WA: &Pose, b: &Solid, X_WB: &Pose, query: DistanceQuery, hint: &mut DVec3) -> f64 {
    if !(has_hull(a) && has_hull(b) && X_WA.is_finite() && X_WB.is_finite()) {
        return f64::NEG_INFINITY;
    }
    let X_AB = Relative::between(X_WA, X_WB);
    let farthest_against = |v: DVec3| support(a, -v) - X_AB.point(support(b, X_AB.direction_back(v)));
    let first = || {
        let between = middle(a) - X_AB.point(middle(b));
        (if between.length_squared() > 1e-20 { between } else { DVec3::X }, false)
    };
    let mut local = X_WA.rotation.conjugate() * *hint;
    let found = descend(farthest_against, first, radius(a) + radius(b), query, &mut local);
    *hint = (X_WA.rotation * local).normalize_or_zero();
    found
}

/// The gap of the convex hulls of two solids along the unit vector `n`, from `b` to `a`, metres: a lower bound of their distance. Negative
/// where they overlap in that direction, −∞ where one has no hull. The frame and `n` are those of [`hull_distance`]'s poses.
#[must_use]
pub fn hull_gap(a: &Solid, X_WA: &Pose, b: &Solid, X_WB: &Pose, n: DVec3) -> f64 {
    if !(has_hull(a) && has_hull(b)) {
        return f64::NEG_INFINITY;
    }
    let nearest_of_a = X_WA.transform_point(support(a, X_WA.rotation.conjugate() * -n));
    let nearest_of_b = X_WB.transform_point(support(b, X_WB.rotation.conjugate() * n));
    n.dot(nearest_of_a - nearest_of_b) - radius(a) - radius(b)
}

fn has_hull(solid: &Solid) -> bool {
    match solid {
        Solid::Convex(_) => true,
        Solid::Mesh(mesh) => !mesh.hull.points.is_empty(),
    }
}

fn radius(solid: &Solid) -> f64 {
    match solid {
        Solid::Convex(convex) => convex.radius,
        Solid::Mesh(mesh) => mesh.hull.slack,
    }
}

fn middle(solid: &Solid) -> DVec3 {
    match solid {
        Solid::Convex(convex) => convex.core.center(),
        Solid::Mesh(mesh) => mesh.hull.middle,
    }
}

fn support(solid: &Solid, d: DVec3) -> DVec3 {
    match solid {
        Solid::Convex(convex) => convex.core.support(d),
        Solid::Mesh(mesh) => mesh.hull.support(d),
    }
}
