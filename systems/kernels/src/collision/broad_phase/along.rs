//! Whether a separating direction that an exact query found in one lane also separates the pair in the other lanes.
//!
//! The direction moves with the nearest common ancestor of the two bodies. Where a mesh has a hull, the support of the hull
//! counts instead of that of its bounding volume. The kernel is apart from `block_of_samples` because the callers run it between exact
//! queries, on one pair at a time.

use crate::collision::broad_phase::bounds::form_along;
use crate::collision::broad_phase::open_pairs::Open;
use crate::collision::broad_phase::placed::{BroadPhaseScratch, approach, place_solid};
use crate::collision::samples::motion_samples::MotionSamples;
use crate::collision::scene::bounding::BoundingVolume;
use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_set::PairSet;
use crate::lanes::geometry::{Rotation, Vector3};
use crate::lanes::level::Kernel;
use crate::lanes::vector::{Isa, Lanes, Mask};
use glam::DVec3;

/// Whether one direction sets a pair apart in lanes.
pub(crate) struct Along<'a> {
    pub scene: &'a CollisionScene,
    pub pairs: &'a PairSet,
    pub motion_samples: &'a MotionSamples,
    pub scratch: &'a mut BroadPhaseScratch,
    pub guard: f64,
    pub open: Open,
    /// A unit vector from the second solid to the first in the world, in lane `found_in`.
    pub n: DVec3,
    pub found_in: usize,
}

impl Kernel for Along<'_> {
    /// The lanes that stay open, and what the others keep.
    type Output = (u16, f32);

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> (u16, f32) {
        let Along { scene, pairs, motion_samples, scratch, guard, open, n, found_in } = self;
        let active = pairs.active(open.active);
        let closer = approach(isa, scene, pairs, motion_samples, scratch, active);
        let pair = &scene.pairs[open.pair as usize];
        let sides = [pair.first.at(), pair.second.at()];
        for solid in sides {
            place_solid(isa, scene, motion_samples, scratch, solid);
        }
        // The direction stays with the bodies' nearest common ancestor.
        let n = match pairs.ancestor(scene, active) {
            Some(body) if motion_samples.body_moves(Some(body)) => {
                let rows = &motion_samples.poses[body.at()];
                let v = |i: usize| {
                    DVec3::new(rows[i][found_in].into(), rows[i + 1][found_in].into(), rows[i + 2][found_in].into())
                };
                let own = DVec3::new(v(0).dot(n), v(3).dot(n), v(6).dot(n));
                Rotation::<I::F32>::load(isa, &rows[..9]).turn(Vector3::splat(isa, own))
            }
            _ => Vector3::splat(isa, n),
        };
        // A little shorter than one, so that rounding makes no gap.
        let n = n.scaled(I::F32::splat(isa, 1.0 - 8.0 * f32::EPSILON));
        let [a, b] = sides.map(|i| &scratch.solids[i]);
        let (at_a, at_b) = (Vector3::<I::F32>::load(isa, &a[..3]), Vector3::load(isa, &b[..3]));
        let (axes_a, axes_b) = (Rotation::load(isa, &a[3..]), Rotation::load(isa, &b[3..]));
        let [outer_a, outer_b] = sides.map(|i| &scene.solids[i].bounding);
        let gap = n.dot(at_a.minus(at_b))
            - support::<I>(isa, outer_a, &axes_a, n.negated())
            - support::<I>(isa, outer_b, &axes_b, n);
        let free = gap - closer - I::F32::load(isa, &scratch.slack);
        let near = !I::F32::constant(isa, pairs.margins[open.pair as usize] + guard).le(free);
        let mask = <I::F32 as Lanes>::Mask::from_bits(isa, u32::from(open.lanes));
        let kept = I::F32::select(near | !mask, I::F32::constant(isa, f64::INFINITY), free);
        (near.bits() as u16 & open.lanes, kept.least())
    }
}

/// How far a solid, or its hull, reaches along a direction from its centre.
#[inline(always)]
fn support<I: Isa>(isa: I, bounding: &BoundingVolume, axes: &Rotation<I::F32>, n: Vector3<I::F32>) -> I::F32 {
    if bounding.hull.is_empty() {
        return form_along(isa, &bounding.form, axes, n);
    }
    let d = axes.turn_back(n);
    let mut most = I::F32::constant(isa, f64::NEG_INFINITY);
    for p in &bounding.hull {
        most = most.max(d.x * p[0] + (d.y * p[1] + d.z * p[2]));
    }
    most + bounding.hull_slack
}
