//! The exact verdict of one configuration.

use crate::collision::convex::gjk::DistanceQuery;
use crate::collision::narrow_phase::scratch::CollisionScratch;
use crate::collision::scene::collision_scene::{CollisionScene, Group, PairId};
use crate::collision::scene::pair_query::{
    Contact, apart, body_poses, contained, contained_at, exact_clearance, pair_clearance, place_balls, rough_clearance,
    sure_contact,
};
use crate::collision::scene::pair_set::{ActiveGroup, PairSet};
use crate::collision::solids::volumes::Ball;
use foliate_components::Pose;
use glam::DVec3;

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
    let query = DistanceQuery { relative: 0.01, ..DistanceQuery::exact(needed) };
    let clearance = exact_clearance(scene, id, X, query, &mut DVec3::ZERO.clone());
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

/// Likewise of the pairs that locked joints hold together ([`CollisionScene::fixed_pairs`]), which no other verdict tests: if
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
    let mut balls = Vec::new();
    place_balls(scene, X_WJ, &mut balls);
    let near = |group: &&Group| {
        let most = margins[group.start as usize..group.end as usize].iter().copied().fold(0.0, f64::max);
        of(group) && !apart(&balls[group.first as usize], &balls[group.second as usize], most + guard)
    };
    let ids = scene.groups.iter().filter(near).flat_map(|group| group.start..group.end);
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
            pair_clearance(scene, id, X_WJ, DistanceQuery::exact(so_far.max(0.0)), &mut DVec3::ZERO.clone())
        };
        let farther = found >= so_far;
        if !farther {
            least = Some(Contact { pair: id, clearance: found });
        }
    }
    least
}
