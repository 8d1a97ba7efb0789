//! Bodies that a closed chain keeps where they are to one another, though joints move between them.
//!
//! A hand that holds what another hand carries stays where it is on it, by the constraint that the motion is kept on. The
//! joints around the circle know nothing of that: what they can bring the two closer is decimetres, what the constraint leaves
//! is a tenth of a millimetre. One query at the start proves such a pair for the whole motion.

use crate::collision::convex::gjk::DistanceQuery;
use crate::collision::samples::motion_samples::MotionSamples;
use crate::collision::scene::body_chains::BodyChains;
use crate::collision::scene::collision_scene::{CollisionScene, PairId};
use crate::collision::scene::pair_query::{exact_clearance, hull_clearance, rough_clearance, solid_balls};
use crate::collision::scene::pair_set::{ActiveGroup, PairSet, RigidPair};
use crate::collision::solids::volumes::Ball;
use foliate_components::Pose;
use foliate_components::robot::JointIndex;
use glam::DVec3;

/// The rigid pair that keeps the two clusters of a group together along a motion: where all joints between each of them and one
/// of the pair's bodies stand still.
pub(crate) fn rigid_pair_of<'a>(
    scene: &CollisionScene,
    pairs: &'a PairSet,
    motion_samples: &MotionSamples,
    active: &ActiveGroup,
) -> Option<&'a RigidPair> {
    if pairs.rigid_pairs.is_empty() {
        return None;
    }
    let group = &scene.groups[active.group as usize];
    let [first, second] =
        [group.first, group.second].map(|c| mover(&pairs.chains, motion_samples, scene.clusters[c as usize].body));
    pairs.rigid_pairs.iter().find(|rigid_pair| {
        let ends = [rigid_pair.a, rigid_pair.b].map(|body| mover(&pairs.chains, motion_samples, body));
        ends == [first, second] || ends == [second, first]
    })
}

/// The nearest joint above a body, its own included, that moves along the motion; none where the body stands still.
fn mover(chains: &BodyChains, motion_samples: &MotionSamples, mut body: Option<JointIndex>) -> Option<JointIndex> {
    // Rigid attachments close no circle.
    while let Some(index) = body.filter(|&index| !motion_samples.joint_moves(index.0)) {
        body = chains.parent(index);
    }
    body
}

/// A clearance that a pair of shapes on a rigid pair keeps along the whole motion, metres: at least `keep`, or nothing is known.
pub(crate) fn kept_clearance(
    scene: &CollisionScene,
    id: PairId,
    (rigid_pair, within): (&RigidPair, f64),
    X_WJ: &[Pose],
    keep: f64,
) -> Option<f64> {
    let origin = rigid_pair.b.map_or(rigid_pair.origin, |b| X_WJ[b.at()].transform_point(rigid_pair.origin));
    let farthest = |ball: Ball| ball.center.distance(origin) + ball.radius;
    let [first, second] = solid_balls(scene, id, X_WJ).map(farthest);
    if !(first.is_finite() && second.is_finite() && within.is_finite()) {
        return None;
    }
    // Whichever of the two is taken to move.
    let closer = within * (1.0 + first.min(second));
    let needed = keep + closer;
    let holds = |found: f64| (found >= needed).then_some(found - closer);
    let X = [scene.pairs[id.at()].first, scene.pairs[id.at()].second]
        .map(|shape| scene.solids[shape.at()].body.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]));
    // Whether it is enough, and nothing else.
    let query = DistanceQuery { floor: f64::NEG_INFINITY, ground: f64::NEG_INFINITY, ..DistanceQuery::exact(needed) };
    holds(rough_clearance(scene, id, X_WJ, needed))
        .or_else(|| holds(hull_clearance(scene, id, X, query, &mut DVec3::ZERO.clone())))
        .or_else(|| holds(exact_clearance(scene, id, X, query, &mut DVec3::ZERO.clone())))
}
