//! Exact queries on one pair of a scene at given poses of its bodies.
//!
//! A query proceeds from cheap to exact: bounding balls, bounding capsules (`rough_clearance`), hulls (`hull_clearance`), the
//! solids themselves (`exact_clearance`). `surely_colliding` compares inscribed capsules, and `contained` asks whether a closed
//! mesh contains the other solid. These queries are apart from `collision_scene`, so that the data of the scene does not depend
//! on the distance algorithms. Discrete checks, certificates and the search for the least clearance share them.

use crate::collision::convex::core::Convex;
use crate::collision::convex::gjk::DistanceQuery;
use crate::collision::distance::hull_distance::{hull_distance, hull_gap};
use crate::collision::distance::query::clearance;
use crate::collision::scene::collision_scene::{CollisionScene, Pair, PairId};
use crate::collision::scene::inscribed::SURE;
use crate::collision::scene::scene_solid::SceneSolid;
use crate::collision::solids::mesh_tree::MeshTree;
use crate::collision::solids::solid::Solid;
use crate::collision::solids::volumes::{Ball, Capsule};
use foliate_components::Pose;
use glam::DVec3;

/// What inscribed volumes show of two solids of a scene whose bodies have these poses: minus how far they overlap at least, metres;
/// none where they do not overlap by more than rounding.
pub(crate) fn overlap(a: &SceneSolid, X_WI: &Pose, b: &SceneSolid, X_WJ: &Pose) -> Option<f64> {
    let (inner_a, inner_b) = (a.inscribed.as_ref()?.capsule.moved(X_WI), b.inscribed.as_ref()?.capsule.moved(X_WJ));
    let [p, q] = nearest(&inner_a, &inner_b);
    let mut least = p.distance(q) - inner_a.radius - inner_b.radius;
    if least >= -SURE {
        least = least.min(beyond(a, X_WI, q) - inner_b.radius).min(beyond(b, X_WJ, p) - inner_a.radius);
    }
    (least < -SURE).then_some(least)
}

/// How far a point in the world is from a convex solid; 0 inside the core, infinite for a mesh.
fn beyond(solid: &SceneSolid, X_WJ: &Pose, p: DVec3) -> f64 {
    match &solid.solid {
        Solid::Convex(Convex { core, radius }) => {
            let p = (X_WJ * solid.X_JS).inverse_transform_point(p);
            core.closest_to(p).distance(p) - radius
        }
        Solid::Mesh(_) => f64::INFINITY,
    }
}

/// A point of each capsule's axis, nearly the closest two.
fn nearest(a: &Capsule, b: &Capsule) -> [DVec3; 2] {
    let (u, v, r) = (a.half, b.half, a.middle - b.middle);
    let (uu, vv, uv) = (u.length_squared().max(1e-12), v.length_squared().max(1e-12), u.dot(v));
    let unit = |x: f64| x.clamp(-1.0, 1.0);
    let determinant = (uu * vv - uv * uv).max(1e-9 * uu * vv);
    let s = unit((uv * v.dot(r) - vv * u.dot(r)) / determinant);
    let t = unit((uv * s + v.dot(r)) / vv);
    let s = unit((uv * t - u.dot(r)) / uu);
    [a.middle + u * s, b.middle + v * t]
}

/// Writes the clusters' balls in the world.
pub(crate) fn place_balls(scene: &CollisionScene, X_WJ: &[Pose], balls: &mut Vec<Ball>) {
    balls.clear();
    balls.extend(scene.clusters.iter().map(|cluster| match cluster.body {
        Some(body) => {
            Ball { center: X_WJ[body.at()].transform_point(cluster.ball.center), radius: cluster.ball.radius }
        }
        None => cluster.ball,
    }));
}

/// The balls of a pair's two shapes in the world.
#[inline]
pub(crate) fn solid_balls(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> [Ball; 2] {
    let pair = &scene.pairs[id.at()];
    [pair.first, pair.second].map(|shape| {
        let solid = &scene.solids[shape.at()];
        match solid.body {
            Some(body) => Ball { center: X_WJ[body.at()].transform_point(solid.ball.center), ..solid.ball },
            None => solid.ball,
        }
    })
}

/// A pair that is too close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Which.
    pub pair: PairId,
    /// A lower bound of its distance, metres; not positive where the two (may) overlap (minus how far what lies inside of them
    /// overlaps, where that says enough), −∞ where one contains the other, or some part of it, or a number is not finite.
    pub clearance: f64,
}

/// Clearance of one pair: balls, then capsules, then the exact query.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn pair_clearance(
    scene: &CollisionScene,
    id: PairId,
    X_WJ: &[Pose],
    query: DistanceQuery,
    hint: &mut DVec3,
) -> f64 {
    let rough = rough_clearance(scene, id, X_WJ, query.needed);
    if rough >= query.needed {
        return rough;
    }
    exact_clearance(scene, id, body_poses(scene, id, X_WJ), query, hint)
}

/// As [`pair_clearance`], with nothing asked first; from the poses of the two bodies.
pub(crate) fn exact_clearance(
    scene: &CollisionScene,
    id: PairId,
    [X_WI, X_WJ]: [Pose; 2],
    query: DistanceQuery,
    hint: &mut DVec3,
) -> f64 {
    let [a, b] = solids_of(scene, id);
    clearance(&a.solid, &(X_WI * a.X_JS), &b.solid, &(X_WJ * b.X_JS), query, hint)
}

/// The contact of a pair that collides with certainty, as what lies inside of its two solids tells without an exact query: none
/// where they only may.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn surely_colliding(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> Option<Contact> {
    sure_contact(scene, id, body_poses(scene, id, X_WJ))
}

/// As [`surely_colliding`], from the poses of the two bodies.
pub(crate) fn sure_contact(scene: &CollisionScene, id: PairId, X: [Pose; 2]) -> Option<Contact> {
    let [a, b] = solids_of(scene, id);
    let overlap = overlap(a, &X[0], b, &X[1])?;
    let contains = !scene.is_convex(id) && contained_at(scene, id, X);
    Some(Contact { pair: id, clearance: if contains { f64::NEG_INFINITY } else { overlap } })
}

/// As [`exact_clearance`], of the hulls of the two shapes: at most what it gives.
pub(crate) fn hull_clearance(
    scene: &CollisionScene,
    id: PairId,
    [X_WI, X_WJ]: [Pose; 2],
    query: DistanceQuery,
    hint: &mut DVec3,
) -> f64 {
    let [a, b] = solids_of(scene, id);
    hull_distance(&a.solid, &(X_WI * a.X_JS), &b.solid, &(X_WJ * b.X_JS), query, hint)
}

/// The unit vector in the world, from the second to the first, along which the gap of a pair's convex hulls is largest where the bodies
/// have the poses `X_WJ`. `None` where they overlap, or one has no hull.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn separating_direction(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> Option<DVec3> {
    let mut n = DVec3::ZERO;
    let query = DistanceQuery { relative: 0.01, ..DistanceQuery::exact(f64::MAX) };
    let apart = hull_clearance(scene, id, body_poses(scene, id, X_WJ), query, &mut n);
    (apart > 0.0 && n != DVec3::ZERO).then_some(n)
}

/// The gap of a pair's convex hulls along a unit vector of the world, from the second to the first, metres; see [`hull_gap`].
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn hull_gap_along(scene: &CollisionScene, id: PairId, X_WJ: &[Pose], n: DVec3) -> f64 {
    let [a, b] = solids_of(scene, id);
    let [X_WI, X_WJ] = body_poses(scene, id, X_WJ);
    hull_gap(&a.solid, &(X_WI * a.X_JS), &b.solid, &(X_WJ * b.X_JS), n)
}

fn solids_of(scene: &CollisionScene, id: PairId) -> [&SceneSolid; 2] {
    let Pair { first, second, .. } = scene.pairs[id.at()];
    [&scene.solids[first.at()], &scene.solids[second.at()]]
}

/// The poses in the world of the bodies of a pair's two shapes.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn body_poses(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> [Pose; 2] {
    solids_of(scene, id).map(|solid| body_pose(solid, X_WJ))
}

/// At most the clearance of a pair, by balls and, where these are not `needed` apart, by capsules.
pub(crate) fn rough_clearance(scene: &CollisionScene, id: PairId, X_WJ: &[Pose], needed: f64) -> f64 {
    let Pair { first, second, .. } = scene.pairs[id.at()];
    let (a, b) = (&scene.solids[first.at()], &scene.solids[second.at()]);
    let (X_WA, X_WB) = (body_pose(a, X_WJ), body_pose(b, X_WJ));
    let between = X_WA.transform_point(a.ball.center).distance(X_WB.transform_point(b.ball.center));
    let balls = between - a.ball.radius - b.ball.radius;
    if balls >= needed {
        return balls;
    }
    a.capsule.moved(&X_WA).distance(&b.capsule.moved(&X_WB))
}

/// Whether one solid of a pair, whose surfaces are apart, lies inside the other: a closed mesh around it.
///
/// Along a motion it need not be asked again: what starts outside and never touches the surface stays outside.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn contained(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> bool {
    contained_at(scene, id, body_poses(scene, id, X_WJ))
}

/// As [`contained`], from the poses of the two bodies.
pub(crate) fn contained_at(scene: &CollisionScene, id: PairId, [X_WI, X_WJ]: [Pose; 2]) -> bool {
    let [a, b] = solids_of(scene, id);
    holds_some_of(a, &X_WI, b, &X_WJ) || holds_some_of(b, &X_WJ, a, &X_WI)
}

fn holds_some_of(bounding: &SceneSolid, X_WO: &Pose, inscribed: &SceneSolid, X_WI: &Pose) -> bool {
    let Solid::Mesh(mesh) = &bounding.solid else { return false };
    if !mesh.is_closed() {
        return false;
    }
    let X_OI = (X_WO * bounding.X_JS).inverse() * (X_WI * inscribed.X_JS);
    let holds = |mesh: &MeshTree, p: DVec3| mesh.contains(X_OI.transform_point(p));
    match &inscribed.solid {
        Solid::Convex(convex) => holds(mesh, convex.core.center()),
        Solid::Mesh(other) => other.witnesses.iter().any(|&p| holds(mesh, p)),
    }
}

/// Whether two solids touch, to within the micrometre that distances are exact to, or one holds some of the other; from the poses
/// of their bodies. True in doubt.
pub(crate) fn touch(a: &SceneSolid, X_WI: &Pose, b: &SceneSolid, X_WJ: &Pose) -> bool {
    const EXACT: f64 = 1e-6;
    let balls = [(a, X_WI), (b, X_WJ)].map(|(s, X)| Ball { center: X.transform_point(s.ball.center), ..s.ball });
    if apart(&balls[0], &balls[1], EXACT) {
        return false;
    }
    let poses = (X_WI * a.X_JS, X_WJ * b.X_JS);
    let distance =
        clearance(&a.solid, &poses.0, &b.solid, &poses.1, DistanceQuery::exact(EXACT), &mut DVec3::ZERO.clone());
    // Compared so that NaN touches.
    let clear = distance >= EXACT;
    !clear || holds_some_of(a, X_WI, b, X_WJ) || holds_some_of(b, X_WJ, a, X_WI)
}

/// Whether two balls are at least `needed` apart; false in doubt.
#[inline]
pub(crate) fn apart(a: &Ball, b: &Ball, needed: f64) -> bool {
    let reach = a.radius + b.radius + needed;
    reach >= 0.0 && a.center.distance_squared(b.center) >= reach * reach
}

#[inline]
pub(crate) fn body_pose(solid: &SceneSolid, X_WJ: &[Pose]) -> Pose {
    solid.body.map_or(Pose::IDENTITY, |body| X_WJ[body.at()])
}
