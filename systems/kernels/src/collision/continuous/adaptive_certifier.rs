//! The certifier of motions: bounds of sixteen intervals at a time, then exact queries where these leave something open.
//!
//! At the middle of an interval every pair whose clearance is at least its margin plus what the interval can bring it
//! closer (`samples/motion_bound.rs`) is free over all of the interval. A motion is cut into sixteen intervals at once, whose
//! bounds cost about as much as one configuration's exact distances (`broad_phase`). What they leave open is asked exactly,
//! from the middle of the motion outwards; a direction that sets a pair apart at one sample is tried at the others before they
//! are asked (`Along`). Intervals that are still open go on to the next round, cut again, with their open pairs alone. Rounds
//! go from long intervals to short ones, so that a collision anywhere is met after few samples, and nothing right of a known
//! collision is tested again. Intervals that cover the motion are the certificate: nothing tunnels at any speed
//! (Schwarzer, Saha and Latombe 2005).

use crate::collision::broad_phase::along::Along;
use crate::collision::broad_phase::block_of_samples::BroadPhase;
use crate::collision::broad_phase::open_pairs::{ALL, Hits, Open, all_lanes};
use crate::collision::continuous::subdivision::{Parts, reached};
use crate::collision::narrow_phase::pair_at_sample::{Here, NarrowPhase, Outcome};
use crate::collision::narrow_phase::rigid_pairs::{kept_clearance, rigid_pair_of};
use crate::collision::narrow_phase::scratch::{Block, CertifierScratch, CollisionScratch, spare};
use crate::collision::narrow_phase::settings::CertificateSettings;
use crate::collision::samples::interval::{Interval, LANES, Sample};
use crate::collision::scene::collision_scene::{CollisionScene, PairId};
use crate::collision::scene::pair_query::{Contact, place_balls, solid_balls};
use crate::collision::scene::pair_set::{ActiveGroup, PairSet};
use glam::DVec3;

/// Lanes in the order in which they are asked exactly: coarse to fine, the outermost last.
const ORDER: [usize; LANES] = [8, 4, 12, 2, 6, 10, 14, 1, 3, 5, 7, 9, 11, 13, 15, 0];

/// What has been found out about a motion.
pub(crate) struct AdaptiveCertifier<'a> {
    narrow_phase: NarrowPhase<'a>,
    knots: &'a [f64],
    /// How close to a collision the end of the valid prefix has to be, in pieces.
    share: f64,
    /// Where something is known to collide, or is in doubt; in pieces.
    hit: f64,
    /// Nothing beyond is of interest, in pieces.
    pub(crate) limit: f64,
    pub(crate) blocked_by: Option<Contact>,
    /// Where `blocked_by` was sampled, in pieces.
    pub(crate) blocked_at: f64,
    pub(crate) blocked: bool,
    pub(crate) min_clearance: f64,
    samples: u32,
    /// Whether hints are those of this motion.
    hints_are_fresh: bool,
    went: WentTo,
}

/// The piece for which the scalar bound was begun, and the sample to which it went.
#[derive(Clone, Copy, Debug, Default)]
struct WentTo {
    piece: Option<u32>,
    t: f64,
}

impl<'a> AdaptiveCertifier<'a> {
    /// Proves what it can of the motion through `knots`, of at least one piece, that `scratch.motion_samples` has begun.
    pub(crate) fn of(
        scene: &'a CollisionScene,
        knots: &'a [f64],
        pairs: &'a PairSet,
        settings: &'a CertificateSettings,
        scratch: &mut CollisionScratch,
    ) -> Self {
        let pieces = (knots.len() / scene.space.size()).saturating_sub(1) as u32;
        let mut certifier = Self {
            narrow_phase: NarrowPhase { scene, pairs, settings },
            knots,
            share: settings.prefix_resolution * f64::from(pieces),
            hit: f64::INFINITY,
            limit: f64::from(pieces),
            blocked_by: None,
            blocked_at: 0.0,
            blocked: false,
            min_clearance: f64::INFINITY,
            samples: 0,
            hints_are_fresh: false,
            went: WentTo::default(),
        };
        scratch.broad_phase.begin(scene, pairs);
        let mut buffers = std::mem::take(&mut scratch.certifier);
        certifier.run(pieces, &mut buffers, scratch);
        scratch.certifier = buffers;
        certifier
    }

    fn run(&mut self, pieces: u32, buffers: &mut CertifierScratch, scratch: &mut CollisionScratch) {
        buffers.used = [0, 0];
        let block = spare(&mut buffers.rounds[0], &mut buffers.used[0]);
        let mut parts = Parts::default();
        parts.push((Interval::whole(pieces), 0));
        parts.cut_up();
        block.intervals.extend(parts.iter().map(|(interval, _)| *interval));
        self.open_all(block, scratch);
        let mut round = 0;
        while buffers.used[round] > 0 && !self.given_up() {
            buffers.used[1 - round] = 0;
            for number in 0..buffers.used[round] {
                let block = std::mem::take(&mut buffers.rounds[round][number]);
                self.look_into(&block, buffers, 1 - round, scratch);
                buffers.rounds[round][number] = block;
                if self.given_up() {
                    return;
                }
            }
            round = 1 - round;
        }
    }

    /// Every pair that matters is open everywhere, but for rigid pairs that are close enough to rigid.
    fn open_all(&mut self, block: &mut Block, scratch: &CollisionScratch) {
        let NarrowPhase { scene, pairs, settings } = self.narrow_phase;
        let lanes = all_lanes(block.intervals.len());
        for (active, group) in pairs.moving.iter().enumerate() {
            if settings.start_is_free && !scratch.motion_samples.moves_between(group) {
                continue;
            }
            let open = |pair| Open { active: active as u32, pair, lanes };
            let Some(rigid_pair) = rigid_pair_of(scene, pairs, &scratch.motion_samples, group) else {
                block.open.push(open(ALL));
                continue;
            };
            let of_group = &scene.groups[group.group as usize];
            for pair in of_group.start..of_group.end {
                let keep = pairs.margins[pair as usize] + settings.clearance_guard;
                match kept_clearance(
                    scene,
                    PairId(pair),
                    (rigid_pair, settings.rigid_within),
                    &scratch.motion_samples.start,
                    keep,
                ) {
                    Some(clearance) => self.min_clearance = self.min_clearance.min(clearance),
                    None => block.open.push(open(pair)),
                }
            }
        }
    }

    fn given_up(&self) -> bool {
        self.limit <= 0.0 || (self.blocked && self.narrow_phase.settings.all_or_nothing)
    }

    /// Certifies what it can of a block and hands the rest to the next round.
    fn look_into(
        &mut self,
        block: &Block,
        buffers: &mut CertifierScratch,
        next: usize,
        scratch: &mut CollisionScratch,
    ) {
        let lanes = self.lanes_of_interest(&block.intervals);
        if lanes == 0 || block.open.is_empty() {
            return;
        }
        self.samples += lanes.count_ones();
        if self.samples > self.narrow_phase.settings.max_samples {
            self.cut(block.intervals[lanes.trailing_zeros() as usize].left(), None);
            return;
        }
        let NarrowPhase { scene, pairs, settings } = self.narrow_phase;
        scratch.motion_samples.look_at(scene, scratch.level, self.knots, &block.intervals);
        buffers.rest.clear();
        // Where one collision decides, inscribed volumes find most. What does not move is free, as the start is.
        let mut hits = Hits { one_decides: true, ..Hits::default() };
        let free = scratch.level.run(BroadPhase {
            scene,
            pairs,
            motion_samples: &scratch.motion_samples,
            scratch: &mut scratch.broad_phase,
            guard: settings.clearance_guard,
            is_placed: false,
            lanes,
            open: &block.open,
            rest: &mut buffers.rest,
            hits: (settings.all_or_nothing && settings.start_is_free).then_some(&mut hits),
        });
        self.min_clearance = self.min_clearance.min(free.into());
        if hits.colliding != 0 {
            let lane = hits.colliding.trailing_zeros() as usize;
            let (pair, overlap) = hits.pairs[lane];
            let middle = block.intervals[lane].middle();
            self.cut(middle, Some((Contact { pair: PairId(pair), clearance: overlap.into() }, middle)));
        }
        if buffers.rest.is_empty() || self.given_up() {
            return;
        }
        for lane in ORDER {
            let wanted = block.intervals.get(lane).is_some_and(|i| i.left() < self.limit);
            if wanted && buffers.rest.iter().any(|open| open.lanes >> lane & 1 == 1) {
                self.ask_exactly(block, lane, &mut buffers.rest, scratch);
                if self.given_up() {
                    return;
                }
            }
        }
        self.hand_on(block, buffers, next);
    }

    fn lanes_of_interest(&self, intervals: &[Interval]) -> u16 {
        let lane = |(lane, interval): (usize, &Interval)| u16::from(interval.left() < self.limit) << lane;
        intervals.iter().enumerate().map(lane).fold(0, |a, b| a | b)
    }

    /// Exact queries of what is open in one lane.
    // Long: one loop over the open pairs; each outcome changes what is asked of the next pair.
    fn ask_exactly(&mut self, block: &Block, lane: usize, rest: &mut Vec<Open>, scratch: &mut CollisionScratch) {
        let interval = block.intervals[lane];
        let NarrowPhase { scene, pairs, settings } = self.narrow_phase;
        if !self.hints_are_fresh {
            scratch.forget_hints(scene);
            self.hints_are_fresh = true;
        }
        let sample = interval.sample();
        let is_fine = scratch.motion_samples.is_fine(sample, lane);
        // Doubt is for pieces: a span that is not certified is halved.
        let resolution = if matches!(sample, Sample::Knot { .. }) { 0.0 } else { settings.resolution };
        for open in rest.iter_mut().filter(|open| open.lanes >> lane & 1 == 1) {
            let (id, active) = (PairId(open.pair), pairs.active(open.active));
            let closer = scratch.broad_phase.closer(active, lane);
            let pair = &scene.pairs[id.at()];
            let X = [pair.first, pair.second].map(|s| scratch.motion_samples.pose_in(lane, scene.solids[s.at()].body));
            let mut hints = scratch.hints[id.at()];
            let here = Here { X, closer, is_fine, resolution };
            let mut went = self.went;
            let along = |n| self.closer_along(id, active, n, (sample, lane), &mut went, scratch);
            let (outcome, n) = self.narrow_phase.at(id, &here, &mut hints, along);
            self.went = went;
            scratch.hints[id.at()] = hints;
            match outcome {
                Outcome::Certified(free) => {
                    self.min_clearance = self.min_clearance.min(free);
                    open.lanes &= !(1 << lane);
                    let keep = pairs.margins[id.at()] + settings.clearance_guard;
                    let closer = |lane| scratch.broad_phase.closer(active, lane);
                    let (lanes, least) = reached(&block.intervals, lane, free - keep, closer);
                    if open.lanes & lanes != 0 {
                        self.min_clearance = self.min_clearance.min(keep + least);
                        open.lanes &= !lanes;
                    }
                }
                Outcome::Open => {}
                Outcome::Collides(contact) => {
                    // A pair that does not move collides from the start on.
                    let moves = scratch.motion_samples.moves_between(active);
                    self.cut(if moves { interval.middle() } else { 0.0 }, Some((contact, interval.middle())));
                }
                Outcome::Doubtful(contact) => self.cut(interval.left(), Some((contact, interval.middle()))),
            }
            if self.given_up() {
                return;
            }
            let others = open.lanes & self.lanes_of_interest(&block.intervals) & !(1 << lane);
            if n != DVec3::ZERO && others != 0 {
                let (left, free) = scratch.level.run(Along {
                    scene,
                    pairs,
                    motion_samples: &scratch.motion_samples,
                    scratch: &mut scratch.broad_phase,
                    guard: settings.clearance_guard,
                    open: Open { lanes: others, ..*open },
                    n,
                    found_in: lane,
                });
                self.min_clearance = self.min_clearance.min(free.into());
                open.lanes &= !(others & !left);
            }
        }
        rest.retain(|open| open.lanes != 0);
    }

    /// How far an interval of one piece can bring a pair closer along a direction.
    fn closer_along(
        &self,
        id: PairId,
        active: &ActiveGroup,
        n: DVec3,
        (sample, lane): (Sample, usize),
        went: &mut WentTo,
        scratch: &mut CollisionScratch,
    ) -> f64 {
        let NarrowPhase { scene, pairs, .. } = self.narrow_phase;
        let Sample::Inside { piece, t, half_width } = sample else { return f64::INFINITY };
        let CollisionScratch { motion_samples, bound, X_WJ, balls, .. } = scratch;
        if went.piece != Some(piece) {
            motion_samples.pieces.begin_bound((scene, pairs), self.knots, piece, bound);
        }
        if went.piece != Some(piece) || went.t != t {
            motion_samples.poses_in(lane, X_WJ);
            place_balls(scene, X_WJ, balls);
            motion_samples.pieces.look_at_bound(scene, (piece, t, half_width), X_WJ, bound);
            *went = WentTo { piece: Some(piece), t };
        }
        // Which also finds how far the bodies are from the axes.
        bound.approach(scene, pairs, active, balls);
        bound.approach_along(scene, pairs, active, solid_balls(scene, id, X_WJ), n)
    }

    /// Cuts up what is open for the next round.
    fn hand_on(&mut self, block: &Block, buffers: &mut CertifierScratch, next: usize) {
        let CertifierScratch { rounds, used, rest } = buffers;
        let mut lanes = rest.iter().fold(0, |lanes, open| lanes | open.lanes);
        for (lane, interval) in block.intervals.iter().enumerate() {
            if lanes >> lane & 1 == 0 {
                continue;
            }
            let left = interval.left();
            // The prefix is known well enough, or this is as short as intervals get.
            if left < self.limit && (left >= self.hit - self.share || interval.halves().is_none()) {
                self.cut(left, None);
            }
            if left >= self.limit {
                lanes &= !(1 << lane);
            }
        }
        while lanes != 0 {
            let child = spare(&mut rounds[next], &mut used[next]);
            let mut parts = Parts::default();
            // No more than can be cut in two.
            while lanes != 0 && parts.count < LANES / 2 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                parts.push((block.intervals[lane], lane));
            }
            parts.cut_up();
            child.intervals.extend(parts.iter().map(|(interval, _)| *interval));
            for open in rest.iter() {
                let lane = |(place, (_, parent)): (usize, &(Interval, usize))| (open.lanes >> parent & 1) << place;
                let inherited = parts.iter().enumerate().map(lane).fold(0, |a, b| a | b);
                if inherited != 0 {
                    child.open.push(Open { lanes: inherited, ..*open });
                }
            }
        }
    }

    /// Nothing beyond `t` is of interest, because of what was found at a sample, where something was.
    fn cut(&mut self, t: f64, contact: Option<(Contact, f64)>) {
        self.blocked = true;
        if contact.is_some() {
            self.hit = self.hit.min(t);
        }
        if t < self.limit {
            self.limit = t;
            if let Some((contact, at)) = contact {
                (self.blocked_by, self.blocked_at) = (Some(contact), at);
            } else if self.blocked_by.is_none() {
                self.blocked_at = t;
            }
        }
    }
}
