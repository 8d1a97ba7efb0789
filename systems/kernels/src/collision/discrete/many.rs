//! Exact verdicts of many configurations, bounds of sixteen of them first: bounding volumes show what is free, inscribed volumes
//! what collides.

use crate::collision::broad_phase::along::Along;
use crate::collision::broad_phase::block_of_samples::BroadPhase;
use crate::collision::broad_phase::open_pairs::{ALL, Hits, Open, all_lanes};
use crate::collision::convex::gjk::DistanceQuery;
use crate::collision::narrow_phase::scratch::{CollisionScratch, VerdictScratch};
use crate::collision::samples::interval::{Interval, LANES};
use crate::collision::scene::collision_scene::{CollisionScene, PairId};
use crate::collision::scene::pair_query::{Contact, contained_at, exact_clearance};
use crate::collision::scene::pair_set::PairSet;
use crate::kinematics::forward::{Kinematics, RigidAttachment};
use foliate_components::Pose;
use glam::DVec3;

/// For each of `configurations` (whole ones, end to end) what
/// [`first_collision`](crate::collision::discrete::one::first_collision) says of it, appended to `found`: the first pair,
/// moving and constant ones, that is not at least its margin + `guard` apart. Pairs that keep their relative pose in all of
/// sixteen configurations are tested in one of them, so neighbours on a motion cost least. Where several pairs collide a
/// configuration may name another of them than `first_collision`.
///
/// # Panics
/// If `configurations` is not a whole number of them.
#[allow(clippy::too_many_arguments, reason = "as certify_motion")]
pub fn first_collisions(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    rigid_attachments: &[RigidAttachment],
    configurations: &[f64],
    pairs: &PairSet,
    guard: f64,
    scratch: &mut CollisionScratch,
    found: &mut Vec<Option<Contact>>,
) {
    let mut buffers = std::mem::take(&mut scratch.verdicts);
    let verdicts = Verdicts { scene, kinematics, rigid_attachments, pairs, guard };
    for block in configurations.chunks(LANES * scene.space.size()) {
        verdicts.judge(block, Hits::default(), &mut buffers, scratch);
        found.extend_from_slice(&buffers.found);
    }
    scratch.verdicts = buffers;
}

/// The pairs that bounds alone leave open in up to sixteen configurations, each with a bit for every configuration in which
/// it is; pairs that keep their relative pose in all of them have only the lowest. All other pairs are at least their
/// margin + `guard` apart.
///
/// # Panics
/// If `configurations` is not a whole number of them, or more than sixteen.
#[must_use]
#[allow(clippy::too_many_arguments, reason = "as certify_motion")]
pub fn open_to_bounds(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    rigid_attachments: &[RigidAttachment],
    configurations: &[f64],
    pairs: &PairSet,
    guard: f64,
    scratch: &mut CollisionScratch,
) -> Vec<(PairId, u16)> {
    assert!(configurations.len() <= LANES * scene.space.size(), "more than sixteen configurations");
    let mut buffers = std::mem::take(&mut scratch.verdicts);
    Verdicts { scene, kinematics, rigid_attachments, pairs, guard }.broad_phase(
        configurations,
        None,
        &mut buffers,
        scratch,
    );
    let open = buffers.rest.iter().map(|open| (PairId(open.pair), open.lanes)).collect();
    scratch.verdicts = buffers;
    open
}

/// What verdicts are about: pairs, moving and constant ones, that have to be at least their margin + `guard` apart.
#[derive(Clone, Copy, Debug)]
pub struct Verdicts<'a> {
    /// Solids and pairs.
    pub scene: &'a CollisionScene,
    /// Where bodies are.
    pub kinematics: &'a Kinematics,
    /// What objects are attached to; those that are not named are where their own coordinates say.
    pub rigid_attachments: &'a [RigidAttachment],
    /// The pairs.
    pub pairs: &'a PairSet,
    /// Metres beyond the margins.
    pub guard: f64,
}

impl Verdicts<'_> {
    /// Of each row of configurations the first that collides, as its place in the row, and a pair that does; appended to
    /// `found`, one for every row. Rows stand end to end: row `i` ends in front of configuration number `ends[i]`.
    ///
    /// It is what [`first_collisions`] says, but of a row nothing exact is asked behind its first collision.
    ///
    /// # Panics
    /// If `configurations` is not a whole number of them, or the rows are fewer configurations than there are.
    pub fn first_in_rows(
        &self,
        configurations: &[f64],
        ends: &[usize],
        scratch: &mut CollisionScratch,
        found: &mut Vec<Option<(usize, Contact)>>,
    ) {
        let size = self.scene.space.size();
        let first = found.len();
        found.resize(first + ends.len(), None);
        let found = &mut found[first..];
        let mut buffers = std::mem::take(&mut scratch.verdicts);
        let place_of = |number: usize| {
            let row = ends.partition_point(|&end| end <= number);
            (row, number - row.checked_sub(1).map_or(0, |before| ends[before]))
        };
        for (block, start) in configurations.chunks(LANES * size).zip((0..).step_by(LANES)) {
            let mut hits = Hits::default();
            for lane in 0..block.len() / size {
                let (row, place) = place_of(start + lane);
                hits.followers |= u16::from(place > 0) << lane;
                hits.settled |= u16::from(found[row].is_some()) << lane;
            }
            self.judge(block, hits, &mut buffers, scratch);
            for (lane, contact) in buffers.found.iter().enumerate() {
                let (row, place) = place_of(start + lane);
                found[row] = found[row].or(contact.map(|contact| (place, contact)));
            }
        }
        scratch.verdicts = buffers;
    }

    /// The ones of up to sixteen configurations that collide with certainty, as inscribed volumes alone show; the first is the lowest bit.
    ///
    /// # Panics
    /// If `configurations` is not a whole number of them, or more than sixteen.
    #[must_use]
    pub fn surely_colliding(&self, configurations: &[f64], scratch: &mut CollisionScratch) -> u16 {
        let count = configurations.len() / self.scene.space.size();
        assert!(count <= LANES, "more than sixteen configurations");
        let (mut buffers, mut hits) = (std::mem::take(&mut scratch.verdicts), Hits::default());
        self.broad_phase(configurations, Some(&mut hits), &mut buffers, scratch);
        scratch.verdicts = buffers;
        if count == 0 { 0 } else { hits.colliding & all_lanes(count) }
    }

    /// Leaves in `buffers.found` what collides in up to sixteen configurations, as far as `hits` wants to know.
    fn judge(&self, block: &[f64], mut hits: Hits, buffers: &mut VerdictScratch, scratch: &mut CollisionScratch) {
        self.broad_phase(block, Some(&mut hits), buffers, scratch);
        buffers.found.clear();
        buffers.found.resize(block.len() / self.scene.space.size(), None);
        for (lane, found) in buffers.found.iter_mut().enumerate().filter(|(lane, _)| hits.colliding >> lane & 1 == 1) {
            let (pair, overlap) = hits.pairs[lane];
            *found = Some(self.sure_contact(PairId(pair), overlap, lane, scratch));
        }
        self.ask_exactly(&mut hits, buffers, scratch);
    }

    /// Asks exactly what bounds leave open, as far as `hits` wants to know; adds what collides to `buffers.found`.
    pub(crate) fn ask_exactly(&self, hits: &mut Hits, buffers: &mut VerdictScratch, scratch: &mut CollisionScratch) {
        let all = all_lanes(buffers.found.len());
        for &open in &buffers.rest {
            if hits.settled & all == all {
                break;
            }
            self.query(open, hits, scratch, &mut buffers.found);
        }
    }

    /// Leaves in `buffers.rest` what bounds leave open, and in `hits` what collides with certainty.
    fn broad_phase(
        &self,
        configurations: &[f64],
        hits: Option<&mut Hits>,
        buffers: &mut VerdictScratch,
        scratch: &mut CollisionScratch,
    ) {
        buffers.rest.clear();
        let count = configurations.len() / self.scene.space.size();
        if count == 0 {
            return;
        }
        self.place(configurations, 0, buffers, scratch);
        let all = all_lanes(count);
        buffers.open.clear();
        for (number, active) in self.pairs.moving.iter().chain(&self.pairs.constant).enumerate() {
            let moves = scratch.motion_samples.moves_between(active);
            buffers.open.push(Open { active: number as u32, pair: ALL, lanes: if moves { all } else { 1 } });
        }
        let lanes = all & !hits.as_ref().map_or(0, |hits| hits.settled);
        self.bound((lanes, false), hits, buffers, scratch);
    }

    /// Places the bodies in up to sixteen configurations, at least one: all from number `first` on.
    pub(crate) fn place(
        &self,
        configurations: &[f64],
        first: u32,
        buffers: &mut VerdictScratch,
        scratch: &mut CollisionScratch,
    ) {
        let Self { scene, kinematics, rigid_attachments, pairs, .. } = *self;
        let count = configurations.len() / scene.space.size();
        scratch.motion_samples.begin_still((scene, kinematics, rigid_attachments), pairs, configurations);
        scratch.broad_phase.begin(scene, pairs);
        buffers.intervals.clear();
        buffers.intervals.extend((first..count as u32).map(Interval::knot));
        scratch.motion_samples.look_at(scene, scratch.level, configurations, &buffers.intervals);
    }

    /// Adds to `buffers.rest` what bounds leave open of `buffers.open`, and to `hits` what collides with certainty.
    pub(crate) fn bound(
        &self,
        (lanes, is_placed): (u16, bool),
        hits: Option<&mut Hits>,
        buffers: &mut VerdictScratch,
        scratch: &mut CollisionScratch,
    ) {
        scratch.level.run(BroadPhase {
            scene: self.scene,
            pairs: self.pairs,
            motion_samples: &scratch.motion_samples,
            scratch: &mut scratch.broad_phase,
            guard: self.guard,
            is_placed,
            lanes,
            open: &buffers.open,
            rest: &mut buffers.rest,
            hits,
        });
    }

    /// A pair that collides with certainty; surfaces may be apart where one is inside the other.
    fn sure_contact(&self, pair: PairId, overlap: f32, lane: usize, scratch: &CollisionScratch) -> Contact {
        let contains =
            !self.scene.is_convex(pair) && contained_at(self.scene, pair, self.poses_of(pair, lane, scratch));
        Contact { pair, clearance: if contains { f64::NEG_INFINITY } else { overlap.into() } }
    }

    fn poses_of(&self, id: PairId, lane: usize, scratch: &CollisionScratch) -> [Pose; 2] {
        let pair = &self.scene.pairs[id.at()];
        [pair.first, pair.second].map(|solid| scratch.motion_samples.pose_in(lane, self.scene.solids[solid.at()].body))
    }

    /// Asks exactly what is open of a pair.
    fn query(&self, mut open: Open, hits: &mut Hits, scratch: &mut CollisionScratch, found: &mut [Option<Contact>]) {
        let (scene, pairs, id) = (self.scene, self.pairs, PairId(open.pair));
        let moves = scratch.motion_samples.moves_between(pairs.active(open.active));
        let needed = pairs.margins[id.at()] + self.guard;
        let mut n = DVec3::ZERO;
        while open.lanes != 0 {
            let lane = open.lanes.trailing_zeros() as usize;
            open.lanes &= open.lanes - 1;
            if moves && hits.settled >> lane & 1 == 1 {
                continue;
            }
            let X = self.poses_of(id, lane, scratch);
            let query = DistanceQuery { relative: 0.01, ..DistanceQuery::exact(needed) };
            let clearance = exact_clearance(scene, id, X, query, &mut n);
            // Compared so that NaN collides.
            let clear = clearance >= needed;
            let contact = match clear {
                false => Some(Contact { pair: id, clearance }),
                true if contained_at(scene, id, X) => Some(Contact { pair: id, clearance: f64::NEG_INFINITY }),
                true => None,
            };
            match contact {
                Some(contact) if moves => {
                    found[lane] = Some(contact);
                    hits.settle(lane as u32);
                }
                Some(contact) => {
                    found.iter_mut().for_each(|f| *f = f.or(Some(contact)));
                    hits.settled = u16::MAX;
                }
                None if open.lanes != 0 && n != DVec3::ZERO && scene.is_convex(id) => {
                    let (near, _) = scratch.level.run(Along {
                        scene,
                        pairs,
                        motion_samples: &scratch.motion_samples,
                        scratch: &mut scratch.broad_phase,
                        guard: self.guard,
                        open,
                        n,
                        found_in: lane,
                    });
                    open.lanes &= near;
                }
                None => {}
            }
        }
    }
}
