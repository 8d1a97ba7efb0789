//! The loop over the open pairs of one block: it keeps those that the bounds do not prove free.
//!
//! On request, a pair that stays open is also compared by its inscribed volumes (`scene/inscribed.rs`). Overlaps of more
//! than the slack are collisions with certainty.

use crate::collision::broad_phase::bounds::{beside_box, beside_boxes, between_axes, overlap, reach_along};
use crate::collision::broad_phase::open_pairs::{ALL, Hits, Open};
use crate::collision::broad_phase::placed::{BroadPhaseScratch, approach, place_axes, place_clusters, place_solid};
use crate::collision::samples::interval::POSE;
use crate::collision::samples::motion_samples::MotionSamples;
use crate::collision::scene::bounding::{BoundingVolume, Form};
use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_set::PairSet;
use crate::lanes::geometry::{Rotation, Vector3};
use crate::lanes::level::Kernel;
use crate::lanes::vector::{F32Row, Isa, Lanes, Mask};

/// One pass over the open pairs of a block.
pub(crate) struct BroadPhase<'a> {
    pub scene: &'a CollisionScene,
    pub pairs: &'a PairSet,
    pub motion_samples: &'a MotionSamples,
    pub scratch: &'a mut BroadPhaseScratch,
    pub guard: f64,
    /// Whether a pass over other pairs has placed the clusters of this block already.
    pub is_placed: bool,
    /// Lanes of the block that are of interest.
    pub lanes: u16,
    /// Pairs to test, those of a group side by side.
    pub open: &'a [Open],
    /// Those that stay open.
    pub rest: &'a mut Vec<Open>,
    /// Where collisions that are sure go, if they are of interest.
    pub hits: Option<&'a mut Hits>,
}

impl Kernel for BroadPhase<'_> {
    /// What all that is certified keeps, metres.
    type Output = f32;

    // Long: one loop over the open pairs; its parts would share nearly all of its variables.
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> f32 {
        let BroadPhase { scene, pairs, motion_samples, scratch, guard, is_placed, mut lanes, open, rest, mut hits } =
            self;
        if !is_placed {
            scratch.block += 1;
            let most = place_axes(isa, scene, motion_samples, scratch);
            place_clusters(isa, scene, motion_samples, scratch, most);
        }
        let slack = I::F32::load(isa, &scratch.slack);
        let mut least = I::F32::constant(isa, f64::INFINITY);
        let mut at = 0;
        while at < open.len() {
            let number = open[at].active;
            let mut end = at;
            while end < open.len() && open[end].active == number {
                end += 1;
            }
            let run = &open[at..end];
            at = end;
            if lanes == 0 {
                break;
            }
            let active = pairs.active(number);
            // What does not move within the block stands in the first lane, and there for all.
            let is_shared = hits.is_some() && !motion_samples.moves_between(active);
            let group = &scene.groups[active.group as usize];
            let closer = approach(isa, scene, pairs, motion_samples, scratch, active);
            let (a, b) = (&scratch.centers[group.first as usize], &scratch.centers[group.second as usize]);
            let apart = Vector3::<I::F32>::load(isa, a).minus(Vector3::load(isa, b));
            let radii =
                scene.clusters[group.first as usize].ball.radius + scene.clusters[group.second as usize].ball.radius;
            let free = apart.dot(apart).sqrt() - I::F32::constant(isa, radii) - closer - slack;
            let near = !I::F32::constant(isa, active.margin + guard).le(free);
            least = I::F32::select(near, least, least.min(free));
            let near = near.bits() as u16 & if is_shared { 1 } else { lanes };
            if near == 0 {
                continue;
            }
            let taken = closer + slack;
            let all = run[0].pair == ALL;
            let count = if all { (group.end - group.start) as usize } else { run.len() };
            for place in 0..count {
                let item = match all {
                    true => Open { pair: group.start + place as u32, ..run[0] },
                    false => run[place],
                };
                let mask = item.lanes & near & if is_shared { 1 } else { lanes };
                if mask == 0 {
                    continue;
                }
                let pair = &scene.pairs[item.pair as usize];
                let sides = [pair.first.0, pair.second.0];
                for solid in sides {
                    place_solid(isa, scene, motion_samples, scratch, solid as usize);
                }
                let [a, b] = sides.map(|i| (&scene.solids[i as usize].bounding, i as usize));
                let keep = I::F32::constant(isa, pairs.margins[item.pair as usize] + guard);
                let (free, still) =
                    bound_pair::<I>(isa, [a.0, b.0], [&scratch.solids[a.1], &scratch.solids[b.1]], taken, keep, mask);
                let open = I::F32::select(still, I::F32::constant(isa, f64::INFINITY), free);
                least = least.min(open);
                let mut mask = mask & still.bits() as u16;
                if mask == 0 {
                    continue;
                }
                if let (Some(hits), Some(inner_a), Some(inner_b)) =
                    (&mut hits, &scene.solids[a.1].inscribed, &scene.solids[b.1].inscribed)
                    && pairs.margins[item.pair as usize] + guard >= 0.0
                {
                    let rows = [&scratch.solids[a.1], &scratch.solids[b.1]];
                    let overlap = overlap::<I>(isa, [a.0, b.0], [inner_a, inner_b], rows);
                    let sure = (overlap + slack).lt(I::F32::constant(isa, 0.0)).bits() as u16 & mask;
                    if sure != 0 {
                        let mut overlaps = F32Row::default();
                        if is_shared {
                            overlaps = F32Row::splat(overlap.least());
                        } else {
                            overlap.store(&mut overlaps);
                        }
                        hits.add(item.pair, if is_shared { u16::MAX } else { sure }, &overlaps);
                        lanes &= !hits.settled;
                        mask &= !hits.settled;
                    }
                }
                if mask != 0 {
                    rest.push(Open { lanes: mask, ..item });
                }
            }
        }
        least.least()
    }
}

/// Bounds of one pair: what each lane keeps, and in which lanes that is not enough.
#[inline(always)]
fn bound_pair<I: Isa>(
    isa: I,
    bounding: [&BoundingVolume; 2],
    rows: [&[F32Row; POSE]; 2],
    taken: I::F32,
    keep: I::F32,
    mask: u16,
) -> (I::F32, <I::F32 as Lanes>::Mask) {
    let (rotation_a, rotation_b) = (Rotation::<I::F32>::load(isa, &rows[0][3..]), Rotation::load(isa, &rows[1][3..]));
    let apart = Vector3::<I::F32>::load(isa, &rows[0][..3]).minus(Vector3::load(isa, &rows[1][..3]));
    let radii = I::F32::splat(isa, bounding[0].ball + bounding[1].ball);
    let mut free = apart.dot(apart).sqrt() - radii - taken;
    if ((!keep.le(free)).bits() as u16 & mask) == 0 {
        return (free, !keep.le(free));
    }
    let boxes = [matches!(bounding[0].form, Form::Box(_)), matches!(bounding[1].form, Form::Box(_))];
    if let (&Form::Box(half_a), &Form::Box(half_b)) = (&bounding[0].form, &bounding[1].form) {
        free = free.max(beside_boxes(isa, [half_a, half_b], [&rotation_a, &rotation_b], apart) - taken);
    } else if boxes[0] {
        let at = rotation_a.turn_back(apart);
        free = free.max(beside_box(isa, bounding[0], &rotation_a, bounding[1], &rotation_b, at) - taken);
    } else if boxes[1] {
        let at = rotation_b.turn_back(apart);
        free = free.max(beside_box(isa, bounding[1], &rotation_b, bounding[0], &rotation_a, at) - taken);
    }
    if (bounding[0].is_long || !boxes[0] || bounding[1].is_long || !boxes[1])
        && ((!keep.le(free)).bits() as u16 & mask) != 0
    {
        let n = between_axes(isa, bounding, &rotation_a, &rotation_b, apart);
        let gap = n.dot(apart)
            - reach_along(isa, bounding[0], &rotation_a, n)
            - reach_along(isa, bounding[1], &rotation_b, n);
        free = free.max(gap - taken);
    }
    (free, !keep.le(free))
}
