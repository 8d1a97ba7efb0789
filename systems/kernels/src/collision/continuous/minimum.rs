//! How close the closest pair comes along a polyline or a curve, and where: branch and bound over pairs and intervals.
//!
//! The certificate (`adaptive_certifier.rs`) asks "at least the margin, everywhere?" and is content with the first bound that
//! says so; what it knows of the clearance besides is far below the truth. Here the question is how much it is. At the middle
//! of an interval a pair has a distance, and over the interval it comes closer by no more than `samples/motion_bound.rs` says:
//! that gives both a value that is reached and a bound that holds. Pairs whose bound over an interval is good enough for the
//! least value found so far are done there; the others are divided into halves. Pairs that do not move are measured once.

use crate::collision::continuous::minimum_settings::{MinimumClearance, MinimumSettings, Nearest};
use crate::collision::convex::gjk::DistanceQuery;
use crate::collision::narrow_phase::rigid_pairs::{kept_clearance, rigid_pair_of};
use crate::collision::narrow_phase::scratch::CollisionScratch;
use crate::collision::scene::collision_scene::{CollisionScene, PairId};
use crate::collision::scene::pair_query::{exact_clearance, hull_clearance, place_balls, rough_clearance, solid_balls};
use crate::collision::scene::pair_set::{ActiveGroup, PairSet};
use crate::kinematics::forward::{Kinematics, RigidAttachment};
use glam::DVec3;
use std::ops::Range;

/// Intervals are not halved more often than this.
const DEEPEST: u32 = 40;
/// Distances that are asked for exactly are within this, metres.
const EXACT: f64 = 1e-6;
/// Once in so many distances and parts the caller is asked whether to go on.
pub const ASK_EVERY: u32 = 64;
/// Distances are asked for to within this share of what the minimum may be off.
const QUERY_SHARE: f64 = 0.1;

/// The least clearance along the straight motions from knot to knot, to within what `settings` say. `knots` are whole
/// configurations, end to end, at least one; `rigid_attachments` must be those of `pairs`. All pairs of the set count, those that keep
/// their relative pose too, and those that locked joints hold together ([`CollisionScene::fixed_pairs`]).
///
/// Distances to closed meshes are to their surfaces: the caller knows that nothing begins inside one
/// ([`crate::collision::discrete::one::first_collision`]). The search ends at the first place found where two shapes touch. The same
/// arguments give the same answer; `scratch` only lends its buffers. A configuration that is not finite has the bound −∞.
///
/// # Panics
/// If `knots` is not a whole number of configurations of at least one coordinate, or none.
#[must_use]
#[allow(clippy::too_many_arguments, reason = "as certify_polyline")]
pub fn minimum_clearance_along(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    rigid_attachments: &[RigidAttachment],
    knots: &[f64],
    pairs: &PairSet,
    settings: &MinimumSettings,
    scratch: &mut CollisionScratch,
) -> MinimumClearance {
    minimum_clearance_while(scene, kinematics, rigid_attachments, knots, pairs, (settings, &|| true), scratch)
}

/// As [`minimum_clearance_along`], as long as the closure says so: it is asked once in [`ASK_EVERY`] distances and parts. What
/// is proved by then is returned.
///
/// # Panics
/// As [`minimum_clearance_along`].
#[must_use]
#[allow(clippy::too_many_arguments, reason = "as certify_polyline")]
pub fn minimum_clearance_while(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    rigid_attachments: &[RigidAttachment],
    knots: &[f64],
    pairs: &PairSet,
    (settings, go_on): (&MinimumSettings, &dyn Fn() -> bool),
    scratch: &mut CollisionScratch,
) -> MinimumClearance {
    if !knots.iter().all(|x| x.is_finite()) {
        return MinimumClearance::UNKNOWN;
    }
    scratch.motion_samples.begin((scene, kinematics, rigid_attachments), pairs, knots);
    minimum_clearance((scene, kinematics, rigid_attachments), knots, pairs, (settings, go_on), scratch)
}

/// Of the motion through `knots` that `scratch.motion_samples` has begun.
pub(crate) fn minimum_clearance(
    (scene, kinematics, rigid_attachments): (&CollisionScene, &Kinematics, &[RigidAttachment]),
    knots: &[f64],
    pairs: &PairSet,
    (settings, go_on): (&MinimumSettings, &dyn Fn() -> bool),
    scratch: &mut CollisionScratch,
) -> MinimumClearance {
    scratch.forget_hints(scene);
    let mut search = Minimum {
        scene,
        pairs,
        settings,
        best: settings.below,
        nearest: None,
        lower: f64::INFINITY,
        queries: 0,
        touches: false,
        patience: Patience { go_on, asked: 0, is_over: false },
    };
    let moves = |active: &&ActiveGroup| scratch.motion_samples.moves_between(active);
    let moving: Vec<ActiveGroup> = pairs.moving.iter().filter(moves).copied().collect();
    search.at_the_start(scratch);
    search.along((kinematics, rigid_attachments, knots), &moving, scratch);
    search.found()
}

struct Minimum<'a> {
    scene: &'a CollisionScene,
    pairs: &'a PairSet,
    settings: &'a MinimumSettings,
    /// The least clearance found, or what is of no interest from there on.
    best: f64,
    nearest: Option<Nearest>,
    /// What is proved of all that is done.
    lower: f64,
    queries: u64,
    touches: bool,
    patience: Patience<'a>,
}

/// Whether the caller still wants an answer.
struct Patience<'a> {
    go_on: &'a dyn Fn() -> bool,
    asked: u32,
    is_over: bool,
}

impl Patience<'_> {
    fn query(&mut self) {
        self.asked = self.asked.wrapping_add(1);
        if self.asked.is_multiple_of(ASK_EVERY) && !(self.go_on)() {
            self.is_over = true;
        }
    }
}

/// Part of a piece, and the pairs that are open there.
struct Part {
    piece: u32,
    /// Its middle, and half of its width.
    t: f64,
    half: f64,
    open: Range<usize>,
}

/// A pair (or all of a group's) that is not done in a part, and what is known of its clearance there.
#[derive(Clone, Copy)]
struct Open {
    active: u32,
    pair: Option<u32>,
    lower: f64,
}

/// A pair at the middle of a part: where, and what the part can bring it closer.
struct Here<'a> {
    t: f64,
    closer: f64,
    active: Option<&'a ActiveGroup>,
}

impl Minimum<'_> {
    /// What is good enough: whatever keeps this is done.
    fn enough(&self) -> f64 {
        self.best - self.tolerance()
    }

    /// By how much the bound may lie under the least clearance.
    fn tolerance(&self) -> f64 {
        let Self { settings, best, .. } = self;
        let absolute = if *best > 0.0 { settings.absolute.min(0.5 * best) } else { settings.absolute };
        absolute.max(settings.relative * best.abs())
    }

    fn is_over(&self) -> bool {
        self.touches || self.is_spent()
    }

    fn is_spent(&self) -> bool {
        self.patience.is_over || self.queries >= self.settings.max_queries
    }

    fn found(&self) -> MinimumClearance {
        let lower = if self.touches { f64::NEG_INFINITY } else { self.lower };
        let is_cut_short = !self.touches && self.is_spent();
        MinimumClearance { lower, nearest: self.nearest, is_cut_short, queries: self.queries }
    }

    /// Measures all pairs where the motion begins, the nearest by bounds first. Pairs that do not move need no more.
    fn at_the_start(&mut self, scratch: &mut CollisionScratch) {
        let mut poses = std::mem::take(&mut scratch.X_WJ);
        poses.clear();
        poses.extend_from_slice(&scratch.motion_samples.start);
        let rough = |id: PairId| rough_clearance(self.scene, id, &poses, f64::MAX) - self.pairs.margin(id);
        let all = (0..self.scene.pairs.len() as u32).map(PairId);
        let nearest = all.map(|id| (rough(id), id)).min_by(|a, b| a.0.total_cmp(&b.0));
        scratch.X_WJ = poses;
        let here = Here { t: 0.0, closer: 0.0, active: None };
        if let Some((_, first)) = nearest {
            self.look_at(first, &here, scratch);
        }
        for active in self.pairs.moving.iter().chain(&self.pairs.constant) {
            let group = &self.scene.groups[active.group as usize];
            let moves = scratch.motion_samples.moves_between(active);
            for pair in group.start..group.end {
                let bound = self.look_at(PairId(pair), &here, scratch);
                // What moves is bounded along the way.
                if !moves {
                    self.lower = self.lower.min(bound);
                }
            }
        }
        for id in self.scene.fixed_pairs() {
            let bound = self.look_at(id, &here, scratch);
            self.lower = self.lower.min(bound);
        }
    }

    /// Measures what moves, from whole pieces to ever shorter parts of them.
    fn along(
        &mut self,
        (kinematics, rigid_attachments, knots): (&Kinematics, &[RigidAttachment], &[f64]),
        moving: &[ActiveGroup],
        scratch: &mut CollisionScratch,
    ) {
        let size = self.scene.space.size();
        let pieces = (knots.len() / size).saturating_sub(1) as u32;
        let mut open = self.open_all(moving, scratch);
        let whole = |piece| Part { piece, t: 0.5, half: 0.5, open: 0..open.len() };
        let mut parts: Vec<Part> = if open.is_empty() { Vec::new() } else { (0..pieces).map(whole).collect() };
        let mut q = vec![0.0; size];
        for _depth in 0..DEEPEST {
            let (mut halves, mut left) = (Vec::new(), Vec::new());
            let mut begun = None;
            for (number, part) in parts.iter().enumerate() {
                self.patience.query();
                if self.is_over() {
                    let rest = parts[number..].iter().flat_map(|part| &open[part.open.clone()]).chain(&left);
                    self.lower = rest.fold(self.lower, |lower, open| lower.min(open.lower));
                    return;
                }
                let CollisionScratch { motion_samples, bound, .. } = scratch;
                if begun != Some(part.piece) {
                    motion_samples.pieces.begin_bound((self.scene, self.pairs), knots, part.piece, bound);
                    begun = Some(part.piece);
                }
                motion_samples.pieces.configuration(self.scene, knots, (part.piece, part.t), &mut q);
                scratch.X_WJ.resize(kinematics.bodies(), foliate_components::Pose::IDENTITY);
                kinematics.forward(&q, &mut scratch.X_WJ);
                kinematics.carry(&q, rigid_attachments, &mut scratch.X_WJ);
                place_balls(self.scene, &scratch.X_WJ, &mut scratch.balls);
                let CollisionScratch { motion_samples, bound, X_WJ, .. } = scratch;
                motion_samples.pieces.look_at_bound(self.scene, (part.piece, part.t, part.half), X_WJ, bound);
                let first = left.len();
                self.look_into(part, &open[part.open.clone()], moving, &mut left, scratch);
                let (rest, half) = (first..left.len(), 0.5 * part.half);
                if !rest.is_empty() {
                    halves.extend([-half, half].map(|by| Part { t: part.t + by, half, open: rest.clone(), ..*part }));
                }
            }
            (parts, open) = (halves, left);
        }
        self.lower = open.iter().fold(self.lower, |lower, open| lower.min(open.lower));
    }

    /// Everything that moves is open, but for rigid pairs that are close enough to rigid.
    fn open_all(&mut self, moving: &[ActiveGroup], scratch: &CollisionScratch) -> Vec<Open> {
        let mut open = Vec::with_capacity(moving.len());
        for (number, active) in moving.iter().enumerate() {
            let entry = |pair| Open { active: number as u32, pair, lower: f64::NEG_INFINITY };
            let Some(rigid_pair) = rigid_pair_of(self.scene, self.pairs, &scratch.motion_samples, active) else {
                open.push(entry(None));
                continue;
            };
            let group = &self.scene.groups[active.group as usize];
            for pair in group.start..group.end {
                let (id, margin) = (PairId(pair), self.pairs.margin(PairId(pair)));
                let (within, keep) = (self.settings.rigid_within, self.enough() + margin);
                match kept_clearance(self.scene, id, (rigid_pair, within), &scratch.motion_samples.start, keep) {
                    Some(kept) => self.lower = self.lower.min(kept - margin),
                    None => open.push(entry(Some(pair))),
                }
            }
        }
        open
    }

    /// Settles what it can of a part; what is left open goes to `left`.
    fn look_into(
        &mut self,
        part: &Part,
        open: &[Open],
        moving: &[ActiveGroup],
        left: &mut Vec<Open>,
        scratch: &mut CollisionScratch,
    ) {
        for entry in open {
            // The least clearance may have fallen since.
            if entry.lower >= self.enough() {
                self.lower = self.lower.min(entry.lower);
                continue;
            }
            let active = &moving[entry.active as usize];
            let group = &self.scene.groups[active.group as usize];
            let closer = scratch.bound.approach(self.scene, self.pairs, active, &scratch.balls);
            let here = Here { t: f64::from(part.piece) + part.t, closer, active: Some(active) };
            let which = match entry.pair {
                Some(pair) => pair..pair + 1,
                None => {
                    let [a, b] = [group.first, group.second].map(|cluster| scratch.balls[cluster as usize]);
                    let apart = a.center.distance(b.center) - a.radius - b.radius - active.margin - closer;
                    if apart >= self.enough() {
                        self.lower = self.lower.min(apart);
                        continue;
                    }
                    group.start..group.end
                }
            };
            for pair in which {
                let lower = self.look_at(PairId(pair), &here, scratch).max(entry.lower);
                if self.touches {
                    return;
                }
                if lower >= self.enough() {
                    self.lower = self.lower.min(lower);
                } else {
                    left.push(Open { active: entry.active, pair: Some(pair), lower });
                }
            }
        }
    }

    /// Measures a pair where the bodies are, notes how close it is there if that is news, and returns what bounds its
    /// clearance over the part around it.
    fn look_at(&mut self, id: PairId, here: &Here<'_>, scratch: &mut CollisionScratch) -> f64 {
        let (scene, margin) = (self.scene, self.pairs.margin(id));
        let poses = if here.active.is_some() { &scratch.X_WJ } else { &scratch.motion_samples.start };
        let needed = self.enough() + margin + here.closer;
        let rough = rough_clearance(scene, id, poses, needed);
        if rough >= needed {
            return rough - here.closer - margin;
        }
        self.queries += 1;
        self.patience.query();
        let pair = &scene.pairs[id.at()];
        let X = [pair.first, pair.second]
            .map(|s| scene.solids[s.at()].body.map_or(foliate_components::Pose::IDENTITY, |body| poses[body.at()]));
        let balls = solid_balls(scene, id, poses);
        let tolerance = self.tolerance().min(self.settings.absolute) * QUERY_SHARE;
        let share = (self.settings.relative * QUERY_SHARE).min(0.5);
        let floor = (self.best + margin).min(needed);
        let query = DistanceQuery { needed, floor, ground: floor, absolute: tolerance, relative: share };
        let along = |n: DVec3, gap: f64| match here.active {
            Some(active) if gap > 0.0 && n != DVec3::ZERO => {
                gap - scratch.bound.approach_along(scene, self.pairs, active, balls, n)
            }
            _ => f64::NEG_INFINITY,
        };
        let hints = &mut scratch.hints[id.at()];
        let mut bound = f64::NEG_INFINITY;
        if !scene.is_convex(id) {
            // Hulls of meshes are apart by no more than the meshes are, and cost far less.
            let apart = hull_clearance(scene, id, X, query, &mut hints.hulls);
            bound = (apart - here.closer).max(along(hints.hulls, apart));
            if bound - margin >= self.enough() && apart >= floor {
                return bound - margin;
            }
        }
        let found = exact_clearance(scene, id, X, query, &mut hints.solids);
        bound = bound.max(found - here.closer);
        if scene.is_convex(id) {
            bound = bound.max(along(hints.solids, found));
        }
        if found < floor {
            // News are rare enough to be told exactly.
            let exact = exact_clearance(scene, id, X, DistanceQuery::exact(f64::MAX), &mut hints.solids);
            self.note(id, here.t, exact, exact + EXACT - margin);
        }
        bound - margin
    }

    /// A pair is as close as this at a place.
    fn note(&mut self, pair: PairId, t: f64, distance: f64, clearance: f64) {
        // Compared so that NaN touches.
        let apart = distance > 0.0;
        self.touches |= !apart;
        if clearance < self.best || !apart {
            self.best = clearance;
            self.nearest = Some(Nearest { pair, t, clearance });
        }
    }
}
