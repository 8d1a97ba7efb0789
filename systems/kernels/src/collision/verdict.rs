//! The exact verdict of one configuration.

use super::bounds::Ball;
use super::distance::{Ask, Solid, clearance};
use super::hull::hull_distance;
use super::inner::overlap;
use super::mesh_tree::MeshTree;
use super::pairs::{ActiveGroup, PairSet};
use super::scene::{CollisionScene, Group, Pair, PairId, SceneSolid};
use super::scratch::{CollisionScratch, place_balls};
use foliate_components::Pose;
use glam::DVec3;

/// A pair that is too close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Which.
    pub pair: PairId,
    /// A lower bound of its distance, metres; not positive where the two (may) overlap (minus how far what lies inside of them
    /// overlaps, where that says enough), −∞ where one contains the other, or some part of it, or a number is not finite.
    pub clearance: f64,
}

/// The first pair of `pairs`, moving and constant ones, that is not at least its margin + `guard` apart, or of which one
/// lies inside the other (closed meshes are solids). `X_WJ` are the poses of the bodies in the world.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn first_collision(
    scene: &CollisionScene,
    X_WJ: &[Pose],
    pairs: &PairSet,
    guard: f64,
    scratch: &mut CollisionScratch,
) -> Option<Contact> {
    place_balls(scene, X_WJ, &mut scratch.balls);
    let mut groups = pairs.moving.iter().chain(&pairs.constant);
    groups.find_map(|g| first_in_group(scene, X_WJ, &pairs.margins, g, guard, &scratch.balls))
}

fn first_in_group(
    scene: &CollisionScene,
    X_WJ: &[Pose],
    margins: &[f64],
    active: &ActiveGroup,
    guard: f64,
    balls: &[Ball],
) -> Option<Contact> {
    let group = &scene.groups[active.group as usize];
    if apart(&balls[group.first as usize], &balls[group.second as usize], active.margin + guard) {
        return None;
    }
    (group.start..group.end).find_map(|index| contact_of(scene, X_WJ, margins, PairId(index), guard))
}

/// The contact of a pair, where it is not at least its margin + `guard` apart.
fn contact_of(scene: &CollisionScene, X_WJ: &[Pose], margins: &[f64], id: PairId, guard: f64) -> Option<Contact> {
    let needed = margins[id.at()] + guard;
    if rough_clearance(scene, id, X_WJ, needed) >= needed.max(0.0) {
        return None;
    }
    let X = body_poses(scene, id, X_WJ);
    if needed >= 0.0
        && let Some(contact) = sure_contact(scene, id, X)
    {
        return Some(contact);
    }
    let ask = Ask { relative: 0.01, ..Ask::exact(needed) };
    let clearance = exact_clearance(scene, id, X, ask, &mut DVec3::ZERO.clone());
    // Compared so that NaN collides.
    let clear = clearance >= needed;
    if !clear {
        return Some(Contact { pair: id, clearance });
    }
    contained_at(scene, id, X).then_some(Contact { pair: id, clearance: f64::NEG_INFINITY })
}

/// All pairs of `pairs` that [`first_collision`] could name, in the order of the scene's pairs.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn all_collisions(scene: &CollisionScene, X_WJ: &[Pose], pairs: &PairSet, guard: f64) -> Vec<Contact> {
    contacts(scene, X_WJ, &pairs.margins, guard, |group| !group.fixed)
}

/// Likewise of the pairs that locked joints hold together ([`CollisionScene::fixed_pairs`]), which no other verdict looks at: if
/// they keep apart once they do so always. `pairs` says which margins they keep.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn rigid_collisions(scene: &CollisionScene, X_WJ: &[Pose], pairs: &PairSet, guard: f64) -> Vec<Contact> {
    contacts(scene, X_WJ, &pairs.margins, guard, |group| group.fixed)
}

fn contacts(
    scene: &CollisionScene,
    X_WJ: &[Pose],
    margins: &[f64],
    guard: f64,
    of: impl Fn(&Group) -> bool,
) -> Vec<Contact> {
    let ids = scene.groups.iter().filter(|group| of(group)).flat_map(|group| group.start..group.end);
    ids.filter_map(|index| contact_of(scene, X_WJ, margins, PairId(index), guard)).collect()
}

/// The pair of `pairs` with the least clearance, to within a micrometre; `None` without pairs. Where several overlap it is
/// the first of them. Containment counts. Margins do not matter.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn min_clearance(
    scene: &CollisionScene,
    X_WJ: &[Pose],
    pairs: impl IntoIterator<Item = PairId>,
) -> Option<Contact> {
    let mut least: Option<Contact> = None;
    for id in pairs {
        let so_far = least.map_or(f64::MAX, |c| c.clearance);
        let found = if contained(scene, id, X_WJ) {
            f64::NEG_INFINITY
        } else {
            pair_clearance(scene, id, X_WJ, Ask::exact(so_far.max(0.0)), &mut DVec3::ZERO.clone())
        };
        let farther = found >= so_far;
        if !farther {
            least = Some(Contact { pair: id, clearance: found });
        }
    }
    least
}

/// Clearance of one pair: balls, then capsules, then the exact query.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn pair_clearance(scene: &CollisionScene, id: PairId, X_WJ: &[Pose], ask: Ask, hint: &mut DVec3) -> f64 {
    let rough = rough_clearance(scene, id, X_WJ, ask.needed);
    if rough >= ask.needed {
        return rough;
    }
    exact_clearance(scene, id, body_poses(scene, id, X_WJ), ask, hint)
}

/// As [`pair_clearance`], with nothing asked first; from the poses of the two bodies.
pub(super) fn exact_clearance(
    scene: &CollisionScene,
    id: PairId,
    [X_WI, X_WJ]: [Pose; 2],
    ask: Ask,
    hint: &mut DVec3,
) -> f64 {
    let [a, b] = solids_of(scene, id);
    clearance(&a.solid, &(X_WI * a.X_JS), &b.solid, &(X_WJ * b.X_JS), ask, hint)
}

/// The contact of a pair that collides for sure, as what lies inside of its two solids tells without an exact query: none
/// where they only may.
///
/// # Panics
/// If `X_WJ` is shorter than the number of bodies.
#[must_use]
pub fn surely_colliding(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> Option<Contact> {
    sure_contact(scene, id, body_poses(scene, id, X_WJ))
}

/// As [`surely_colliding`], from the poses of the two bodies.
pub(super) fn sure_contact(scene: &CollisionScene, id: PairId, X: [Pose; 2]) -> Option<Contact> {
    let [a, b] = solids_of(scene, id);
    let overlap = overlap(a, &X[0], b, &X[1])?;
    let contains = !scene.is_convex(id) && contained_at(scene, id, X);
    Some(Contact { pair: id, clearance: if contains { f64::NEG_INFINITY } else { overlap } })
}

/// As [`exact_clearance`], of the hulls of the two shapes: at most what it gives.
pub(super) fn hull_clearance(
    scene: &CollisionScene,
    id: PairId,
    [X_WI, X_WJ]: [Pose; 2],
    ask: Ask,
    hint: &mut DVec3,
) -> f64 {
    let [a, b] = solids_of(scene, id);
    hull_distance(&a.solid, &(X_WI * a.X_JS), &b.solid, &(X_WJ * b.X_JS), ask, hint)
}

fn solids_of(scene: &CollisionScene, id: PairId) -> [&SceneSolid; 2] {
    let Pair { first, second, .. } = scene.pairs[id.at()];
    [&scene.solids[first.at()], &scene.solids[second.at()]]
}

fn body_poses(scene: &CollisionScene, id: PairId, X_WJ: &[Pose]) -> [Pose; 2] {
    solids_of(scene, id).map(|solid| body_pose(solid, X_WJ))
}

/// At most the clearance of a pair, by balls and, where these are not `needed` apart, by capsules.
pub(super) fn rough_clearance(scene: &CollisionScene, id: PairId, X_WJ: &[Pose], needed: f64) -> f64 {
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
pub(super) fn contained_at(scene: &CollisionScene, id: PairId, [X_WI, X_WJ]: [Pose; 2]) -> bool {
    let [a, b] = solids_of(scene, id);
    holds_some_of(a, &X_WI, b, &X_WJ) || holds_some_of(b, &X_WJ, a, &X_WI)
}

fn holds_some_of(outer: &SceneSolid, X_WO: &Pose, inner: &SceneSolid, X_WI: &Pose) -> bool {
    let Solid::Mesh(mesh) = &outer.solid else { return false };
    if !mesh.is_closed() {
        return false;
    }
    let X_OI = (X_WO * outer.X_JS).inverse() * (X_WI * inner.X_JS);
    let holds = |mesh: &MeshTree, p: DVec3| mesh.contains(X_OI.transform_point(p));
    match &inner.solid {
        Solid::Convex(convex) => holds(mesh, convex.core.center()),
        Solid::Mesh(other) => other.witnesses.iter().any(|&p| holds(mesh, p)),
    }
}

/// Whether two solids touch, to within the micrometre that distances are exact to, or one holds some of the other; from the poses
/// of their bodies. True in doubt.
pub(super) fn touch(a: &SceneSolid, X_WI: &Pose, b: &SceneSolid, X_WJ: &Pose) -> bool {
    const EXACT: f64 = 1e-6;
    let balls = [(a, X_WI), (b, X_WJ)].map(|(s, X)| Ball { center: X.transform_point(s.ball.center), ..s.ball });
    if apart(&balls[0], &balls[1], EXACT) {
        return false;
    }
    let poses = (X_WI * a.X_JS, X_WJ * b.X_JS);
    let distance = clearance(&a.solid, &poses.0, &b.solid, &poses.1, Ask::exact(EXACT), &mut DVec3::ZERO.clone());
    // Compared so that NaN touches.
    let clear = distance >= EXACT;
    !clear || holds_some_of(a, X_WI, b, X_WJ) || holds_some_of(b, X_WJ, a, X_WI)
}

/// Whether two balls are at least `needed` apart; false in doubt.
#[inline]
pub(super) fn apart(a: &Ball, b: &Ball, needed: f64) -> bool {
    let reach = a.radius + b.radius + needed;
    reach >= 0.0 && a.center.distance_squared(b.center) >= reach * reach
}

#[inline]
pub(super) fn body_pose(solid: &SceneSolid, X_WJ: &[Pose]) -> Pose {
    solid.body.map_or(Pose::IDENTITY, |body| X_WJ[body.at()])
}
