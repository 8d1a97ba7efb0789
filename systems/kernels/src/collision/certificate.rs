//! A straight motion is free over the continuum, or free up to here.
//!
//! At the middle of an interval every pair whose clearance is at least its margin plus what the interval can bring it
//! closer (velocity_bound.rs) is free over all of the interval; the others go on to the two halves. Intervals
//! are looked at in order of their length, longest first, and from left to right, so a collision anywhere is met after
//! few samples, and nothing right of a known collision is looked at again. Intervals that cover [0, 1] are the certificate:
//! nothing tunnels at any speed (DESIGN §5.5; Schwarzer, Saha and Latombe 2005; hpp-notes card L).

use super::distance::Ask;
use super::pairs::{ActiveGroup, PairSet};
use super::scene::{CollisionScene, PairId};
use super::scratch::{CollisionScratch, place_balls, solid_balls};
use super::verdict::{Contact, exact_clearance, hull_clearance, pair_clearance, rough_clearance};
use crate::kinematics::{Carriage, Kinematics};
use glam::DVec3;

/// What to prove, and how hard to try.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CertificateSettings {
    /// Added to every margin, so that independent checkers agree; metres.
    pub clearance_guard: f64,
    /// Where a pair can move by no more than this within an interval and still is not certified, it is taken to collide:
    /// in doubt, in collision. Metres.
    pub resolution: f64,
    /// How close to the truth the end of the valid prefix has to be, as a share of the motion.
    pub prefix_resolution: f64,
    /// Whether to stop at the first collision found, without looking for the valid prefix.
    pub all_or_nothing: bool,
    /// Whether the start is known to be free: pairs that do not move along this motion are then not looked at.
    pub start_is_free: bool,
    /// Configurations that may be looked at; a motion that needs more is free up to where it is certified by then.
    pub max_samples: u32,
}

impl Default for CertificateSettings {
    fn default() -> Self {
        Self {
            clearance_guard: 1e-5,
            resolution: 1e-4,
            prefix_resolution: 4e-3,
            all_or_nothing: false,
            start_is_free: false,
            max_samples: 20_000,
        }
    }
}

/// Hulls that are this share of what an interval takes apart leave the pair to its halves; below it, the meshes themselves
/// are asked.
const HULL_SHARE: f64 = 0.05;

/// What is proved about a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionVerdict {
    /// All of it keeps all margins.
    Free {
        /// Every pair keeps at least this clearance throughout, metres; a lower bound, and often far below the truth.
        /// Infinite without pairs.
        min_clearance_lower_bound: f64,
    },
    /// Only parameters in [0, t] are proved; t is 0 where nothing is. With `all_or_nothing` t is always 0.
    FreeUntil {
        /// End of the proved prefix.
        t: f64,
        /// The pair that ends it, with its clearance at the sample that did; none where a configuration is not finite
        /// or the samples ran out.
        blocked_by: Option<Contact>,
    },
}

/// Intervals of one length, with their open pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct Level {
    intervals: Vec<Interval>,
    pub(super) runs: Vec<Run>,
    pub(super) pairs: Vec<u32>,
}

/// [k, k + 1] · width, and its runs.
#[derive(Clone, Copy, Debug)]
struct Interval {
    k: u64,
    start: u32,
    end: u32,
}

/// Open pairs of one group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    active: u32,
    start: u32,
    end: u32,
}

impl Level {
    pub(super) fn clear(&mut self) {
        self.intervals.clear();
        self.runs.clear();
        self.pairs.clear();
    }

    /// Every pair is open.
    pub(super) fn fill(&mut self, scene: &CollisionScene, pairs: &PairSet) {
        self.clear();
        for (active, group) in pairs.moving.iter().enumerate() {
            let group = &scene.groups[group.group as usize];
            let start = self.pairs.len() as u32;
            self.pairs.extend(group.start..group.end);
            self.runs.push(Run { active: active as u32, start, end: self.pairs.len() as u32 });
        }
    }

    /// Appends some runs of another level, with their pairs.
    pub(super) fn copy(&mut self, other: &Self, runs: std::ops::Range<u32>) {
        for run in &other.runs[runs.start as usize..runs.end as usize] {
            let start = self.pairs.len() as u32;
            self.pairs.extend_from_slice(&other.pairs[run.start as usize..run.end as usize]);
            self.runs.push(Run { start, end: self.pairs.len() as u32, ..*run });
        }
    }

    /// All runs belong to one interval, the whole motion.
    fn span_the_motion(&mut self) {
        self.intervals.push(Interval { k: 0, start: 0, end: self.runs.len() as u32 });
    }
}

/// Proves clearance along the straight motion from `q_a` to `q_b` (in the sense of the configuration space: joints
/// linearly, roots linearly and on the quaternion geodesic), with carried objects following. `carriages` must be those of
/// `pairs`. For polylines there is [`super::polyline::certify_polyline`].
///
/// Containment in closed meshes is not asked along the way: by continuity it cannot begin without touching, so the
/// caller asks [`super::verdict::first_collision`] at the start.
///
/// # Panics
/// If a configuration is shorter than the configuration space.
#[must_use]
#[allow(clippy::too_many_arguments, reason = "tables, the motion, and buffers: nothing here belongs together")]
pub fn certify_motion(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    carriages: &[Carriage],
    q_a: &[f64],
    q_b: &[f64],
    pairs: &PairSet,
    settings: &CertificateSettings,
    scratch: &mut CollisionScratch,
) -> MotionVerdict {
    let size = scene.space.size();
    if !q_a[..size].iter().chain(&q_b[..size]).all(|x| x.is_finite()) {
        return MotionVerdict::FreeUntil { t: 0.0, blocked_by: None };
    }
    scratch.forget_hints(scene);
    scratch.level.fill(scene, pairs);
    let mut proof = Proof::new((scene, kinematics, carriages), pairs, settings);
    proof.prove_straight((q_a, q_b), scratch);
    proof.verdict()
}

impl CollisionScratch {
    fn prepare(&mut self, scene: &CollisionScene, pairs: &PairSet, q_a: &[f64], q_b: &[f64]) {
        self.make_room(scene);
        scene.space.difference(q_a, q_b, &mut self.delta);
        self.bound.begin(scene, pairs, q_a, &self.delta);
    }

    /// Buffers for one configuration.
    pub(super) fn make_room(&mut self, scene: &CollisionScene) {
        self.q.clear();
        self.q.resize(scene.space.size(), 0.0);
        self.delta.clear();
        self.delta.resize(scene.space.dimension(), 0.0);
        self.X_WJ.clear();
        self.X_WJ.resize(scene.bodies(), foliate_components::Pose::IDENTITY);
    }
}

/// What has been found out about a motion so far.
pub(super) struct Proof<'a> {
    pub(super) scene: &'a CollisionScene,
    pub(super) kinematics: &'a Kinematics,
    pub(super) carriages: &'a [Carriage],
    motion: (&'a [f64], &'a [f64]),
    pub(super) pairs: &'a PairSet,
    pub(super) settings: &'a CertificateSettings,
    /// Of the intervals being looked at.
    width: f64,
    /// Nothing beyond is of interest.
    pub(super) limit: f64,
    pub(super) blocked_by: Option<Contact>,
    pub(super) blocked: bool,
    pub(super) min_clearance: f64,
    pub(super) samples: u32,
}

/// What became of a pair in an interval.
enum Outcome {
    Certified,
    Open,
    /// It collides, at the sample.
    Collides(Contact),
    /// It cannot be certified at the resolution.
    Doubtful(Contact),
}

impl<'a> Proof<'a> {
    pub(super) fn new(
        (scene, kinematics, carriages): (&'a CollisionScene, &'a Kinematics, &'a [Carriage]),
        pairs: &'a PairSet,
        settings: &'a CertificateSettings,
    ) -> Self {
        Self {
            scene,
            kinematics,
            carriages,
            motion: (&[], &[]),
            pairs,
            settings,
            width: 1.0,
            limit: 1.0,
            blocked_by: None,
            blocked: false,
            min_clearance: f64::INFINITY,
            samples: 0,
        }
    }

    /// Looks into a straight motion, at the pairs that `scratch.level` holds.
    pub(super) fn prove_straight(&mut self, motion: (&'a [f64], &'a [f64]), scratch: &mut CollisionScratch) {
        scratch.prepare(self.scene, self.pairs, motion.0, motion.1);
        self.motion = motion;
        let mut level = std::mem::take(&mut scratch.level);
        let mut next = std::mem::take(&mut scratch.next_level);
        level.span_the_motion();
        while !level.intervals.is_empty() && !self.given_up() {
            next.clear();
            for interval in 0..level.intervals.len() {
                self.look_into(&level, level.intervals[interval], &mut next, scratch);
                if self.given_up() {
                    break;
                }
            }
            std::mem::swap(&mut level, &mut next);
            self.width *= 0.5;
        }
        (scratch.level, scratch.next_level) = (level, next);
    }

    pub(super) fn given_up(&self) -> bool {
        self.limit <= 0.0 || (self.blocked && self.settings.all_or_nothing)
    }

    /// Certifies what it can in one interval and hands the rest to the next level.
    fn look_into(&mut self, level: &Level, interval: Interval, next: &mut Level, scratch: &mut CollisionScratch) {
        let left = interval.k as f64 * self.width;
        if left >= self.limit {
            return;
        }
        if self.samples >= self.settings.max_samples {
            self.cut(left, None);
            return;
        }
        self.samples += 1;
        let middle = left + 0.5 * self.width;
        self.go_to(middle, scratch);
        let first_run = next.runs.len() as u32;
        for run in &level.runs[interval.start as usize..interval.end as usize] {
            self.look_at_run(run, &level.pairs, (left, middle), next, scratch);
            if self.given_up() {
                return;
            }
        }
        let last_run = next.runs.len() as u32;
        if last_run == first_run {
            return;
        }
        if self.blocked && self.limit <= left + self.width && self.width <= self.settings.prefix_resolution {
            // Something here or right behind is in collision, and the prefix is known well enough.
            self.cut(left, None);
            return;
        }
        for half in 0..2 {
            next.intervals.push(Interval { k: 2 * interval.k + half, start: first_run, end: last_run });
        }
    }

    fn go_to(&self, t: f64, scratch: &mut CollisionScratch) {
        self.scene.space.interpolate(self.motion.0, self.motion.1, t, &mut scratch.q);
        self.kinematics.forward(&scratch.q, &mut scratch.X_WJ);
        self.kinematics.carry(&scratch.q, self.carriages, &mut scratch.X_WJ);
        place_balls(self.scene, &scratch.X_WJ, &mut scratch.balls);
        scratch.bound.look_at(self.scene, &scratch.X_WJ, 0.5 * self.width);
    }

    /// Looks at the pairs of a run at the sample `middle` of an interval that begins at `left`; what stays open goes to
    /// `next`.
    pub(super) fn look_at_run(
        &mut self,
        run: &Run,
        open: &[u32],
        (left, middle): (f64, f64),
        next: &mut Level,
        scratch: &mut CollisionScratch,
    ) {
        let active = &self.pairs.moving[run.active as usize];
        let group = &self.scene.groups[active.group as usize];
        let closer = scratch.bound.approach(self.scene, self.pairs, active, &scratch.balls);
        if closer == 0.0 && self.settings.start_is_free {
            return;
        }
        let (a, b) = (&scratch.balls[group.first as usize], &scratch.balls[group.second as usize]);
        let between = a.center.distance(b.center) - a.radius - b.radius;
        if between >= active.margin + self.settings.clearance_guard + closer {
            self.min_clearance = self.min_clearance.min(between - closer);
            return;
        }
        let start = next.pairs.len() as u32;
        for &pair in &open[run.start as usize..run.end as usize] {
            match self.look_at_pair(pair, active, closer, scratch) {
                Outcome::Certified => {}
                Outcome::Open => next.pairs.push(pair),
                Outcome::Collides(contact) => {
                    // A pair that does not move collides from the start on.
                    self.cut(if closer == 0.0 { left } else { middle }, Some(contact));
                    next.pairs.push(pair);
                }
                Outcome::Doubtful(contact) => self.cut(left, Some(contact)),
            }
            if self.given_up() {
                return;
            }
        }
        let end = next.pairs.len() as u32;
        if end > start {
            next.runs.push(Run { active: run.active, start, end });
        }
    }

    fn look_at_pair(
        &mut self,
        pair: u32,
        active: &ActiveGroup,
        closer: f64,
        scratch: &mut CollisionScratch,
    ) -> Outcome {
        let id = PairId(pair);
        let keep = self.pairs.margins[id.at()] + self.settings.clearance_guard;
        let needed = keep + closer;
        // Where the directional bound is no help, only a collision at the sample still matters.
        if !self.scene.is_convex(id) {
            return self.look_at_meshes(id, active, closer, scratch);
        }
        let directional = scratch.bound.is_fine();
        let ask = if directional {
            Ask { relative: 0.05, ..Ask::exact(needed) }
        } else {
            Ask { floor: keep, ..Ask::exact(needed) }
        };
        let found = pair_clearance(self.scene, id, &scratch.X_WJ, ask, &mut scratch.hints[id.at()]);
        if found >= needed {
            self.min_clearance = self.min_clearance.min(found - closer);
            return Outcome::Certified;
        }
        if directional && found >= keep {
            // The distance of convex solids is their gap along the hint.
            let (n, balls) = (scratch.hints[id.at()], solid_balls(self.scene, id, &scratch.X_WJ));
            let closer = scratch.bound.approach_along(self.scene, self.pairs, active, balls, n);
            if n != DVec3::ZERO && found >= keep + closer {
                self.min_clearance = self.min_clearance.min(found - closer);
                return Outcome::Certified;
            }
        }
        self.undecided(id, found, keep, closer)
    }

    /// As [`Self::look_at_pair`] where one is a mesh: its hull is asked first, and where hulls are apart a direction is known.
    fn look_at_meshes(
        &mut self,
        id: PairId,
        active: &ActiveGroup,
        closer: f64,
        scratch: &mut CollisionScratch,
    ) -> Outcome {
        let keep = self.pairs.margins[id.at()] + self.settings.clearance_guard;
        let needed = keep + closer;
        let rough = rough_clearance(self.scene, id, &scratch.X_WJ, needed);
        if rough >= needed {
            self.min_clearance = self.min_clearance.min(rough - closer);
            return Outcome::Certified;
        }
        let fine = scratch.bound.is_fine();
        let ask = if fine {
            Ask { relative: 0.05, ..Ask::exact(needed) }
        } else {
            Ask { floor: keep, relative: 0.05, ..Ask::exact(needed) }
        };
        let apart = hull_clearance(self.scene, id, &scratch.X_WJ, ask, &mut scratch.hull_hints[id.at()]);
        if apart >= needed {
            self.min_clearance = self.min_clearance.min(apart - closer);
            return Outcome::Certified;
        }
        if fine && apart >= keep {
            let (n, balls) = (scratch.hull_hints[id.at()], solid_balls(self.scene, id, &scratch.X_WJ));
            let along = scratch.bound.approach_along(self.scene, self.pairs, active, balls, n);
            if n != DVec3::ZERO && apart >= keep + along {
                self.min_clearance = self.min_clearance.min(apart - along);
                return Outcome::Certified;
            }
        }
        if apart - keep >= HULL_SHARE * closer && 2.0 * closer > self.settings.resolution {
            return Outcome::Open;
        }
        let ask = Ask { floor: keep, ..Ask::exact(needed) };
        let found = exact_clearance(self.scene, id, &scratch.X_WJ, ask, &mut scratch.hints[id.at()]);
        if found >= needed {
            self.min_clearance = self.min_clearance.min(found - closer);
            return Outcome::Certified;
        }
        self.undecided(id, found, keep, closer)
    }

    /// What becomes of a pair that is not certified.
    fn undecided(&self, pair: PairId, clearance: f64, keep: f64, closer: f64) -> Outcome {
        let contact = Contact { pair, clearance };
        // Compared so that NaN collides.
        let keeps = clearance >= keep;
        match (keeps, 2.0 * closer > self.settings.resolution) {
            (false, _) => Outcome::Collides(contact),
            (true, true) => Outcome::Open,
            (true, false) => Outcome::Doubtful(contact),
        }
    }

    pub(super) fn cut(&mut self, t: f64, contact: Option<Contact>) {
        self.blocked = true;
        if t < self.limit {
            self.limit = t;
            self.blocked_by = contact.or(self.blocked_by);
        }
    }

    fn verdict(&self) -> MotionVerdict {
        if !self.blocked {
            return MotionVerdict::Free { min_clearance_lower_bound: self.min_clearance };
        }
        let t = if self.settings.all_or_nothing { 0.0 } else { self.limit };
        MotionVerdict::FreeUntil { t, blocked_by: self.blocked_by }
    }
}
