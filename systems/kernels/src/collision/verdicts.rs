//! Exact verdicts of many configurations, bounds of sixteen of them first.

use super::course::{Interval, LANES};
use super::distance::Ask;
use super::pairs::PairSet;
use super::scene::{CollisionScene, PairId};
use super::scratch::CollisionScratch;
use super::sweep::{ALL, Along, Open, Sweep, all_lanes};
use super::verdict::{Contact, contained_at, exact_clearance};
use crate::kinematics::{Carriage, Kinematics};
use glam::DVec3;

/// Buffers of verdicts.
#[derive(Clone, Debug, Default)]
pub(super) struct VerdictScratch {
    intervals: Vec<Interval>,
    open: Vec<Open>,
    rest: Vec<Open>,
}

/// For each of `configurations` (whole ones, end to end) what [`first_collision`](super::verdict::first_collision) says of it,
/// appended to `found`: the first pair, moving and constant ones, that is not at least its margin + `guard` apart.
/// Pairs that keep their relative pose in all of sixteen configurations are looked at in one of them, so neighbours on a
/// motion cost least. Where several pairs collide a configuration may name another of them than `first_collision`.
///
/// # Panics
/// If `configurations` is not a whole number of them.
#[allow(clippy::too_many_arguments, reason = "as certify_motion")]
pub fn first_collisions(
    scene: &CollisionScene,
    kinematics: &Kinematics,
    carriages: &[Carriage],
    configurations: &[f64],
    pairs: &PairSet,
    guard: f64,
    scratch: &mut CollisionScratch,
    found: &mut Vec<Option<Contact>>,
) {
    let mut buffers = std::mem::take(&mut scratch.verdicts);
    for block in configurations.chunks(LANES * scene.space.size()) {
        let bounds = Block { scene, kinematics, carriages, pairs, guard };
        bounds.sweep(block, &mut buffers, scratch);
        bounds.finish(block.len() / scene.space.size(), &mut buffers, scratch, found);
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
    carriages: &[Carriage],
    configurations: &[f64],
    pairs: &PairSet,
    guard: f64,
    scratch: &mut CollisionScratch,
) -> Vec<(PairId, u16)> {
    assert!(configurations.len() <= LANES * scene.space.size(), "more than sixteen configurations");
    let mut buffers = std::mem::take(&mut scratch.verdicts);
    Block { scene, kinematics, carriages, pairs, guard }.sweep(configurations, &mut buffers, scratch);
    let open = buffers.rest.iter().map(|open| (PairId(open.pair), open.lanes)).collect();
    scratch.verdicts = buffers;
    open
}

struct Block<'a> {
    scene: &'a CollisionScene,
    kinematics: &'a Kinematics,
    carriages: &'a [Carriage],
    pairs: &'a PairSet,
    guard: f64,
}

impl Block<'_> {
    /// Leaves in `buffers.rest` what bounds leave open.
    fn sweep(&self, configurations: &[f64], buffers: &mut VerdictScratch, scratch: &mut CollisionScratch) {
        let (scene, pairs) = (self.scene, self.pairs);
        scratch.course.begin((scene, self.kinematics, self.carriages), pairs, configurations);
        scratch.sweep.begin(scene, pairs);
        let count = configurations.len() / scene.space.size();
        buffers.intervals.clear();
        buffers.intervals.extend((0..count as u32).map(Interval::knot));
        buffers.rest.clear();
        if count == 0 {
            return;
        }
        scratch.course.look_at(scene, scratch.level, configurations, &buffers.intervals);
        let all = all_lanes(count);
        buffers.open.clear();
        for (number, active) in pairs.moving.iter().chain(&pairs.constant).enumerate() {
            let moves = scratch.course.moves_between(active);
            buffers.open.push(Open { active: number as u32, pair: ALL, lanes: if moves { all } else { 1 } });
        }
        scratch.level.run(Sweep {
            scene,
            pairs,
            course: &scratch.course,
            scratch: &mut scratch.sweep,
            guard: self.guard,
            lanes: all,
            open: &buffers.open,
            rest: &mut buffers.rest,
        });
    }

    /// Asks exactly what is open.
    fn finish(
        &self,
        count: usize,
        buffers: &mut VerdictScratch,
        scratch: &mut CollisionScratch,
        found: &mut Vec<Option<Contact>>,
    ) {
        let first = found.len();
        found.resize(first + count, None);
        let found = &mut found[first..];
        let rest = std::mem::take(&mut buffers.rest);
        for &open in &rest {
            self.ask(open, scratch, found);
            if found.iter().all(Option::is_some) {
                break;
            }
        }
        buffers.rest = rest;
    }

    fn ask(&self, mut open: Open, scratch: &mut CollisionScratch, found: &mut [Option<Contact>]) {
        let (scene, pairs, id) = (self.scene, self.pairs, PairId(open.pair));
        let moves = scratch.course.moves_between(pairs.active(open.active));
        let needed = pairs.margins[id.at()] + self.guard;
        let pair = &scene.pairs[id.at()];
        let sides = [pair.first.at(), pair.second.at()];
        let mut n = DVec3::ZERO;
        while open.lanes != 0 {
            let lane = open.lanes.trailing_zeros() as usize;
            open.lanes &= open.lanes - 1;
            if moves && found[lane].is_some() {
                continue;
            }
            let X = sides.map(|i| scratch.course.pose_in(lane, scene.solids[i].body));
            let ask = Ask { relative: 0.01, ..Ask::exact(needed) };
            let clearance = exact_clearance(scene, id, X, ask, &mut n);
            // Compared so that NaN collides.
            let clear = clearance >= needed;
            let contact = match clear {
                false => Some(Contact { pair: id, clearance }),
                true if contained_at(scene, id, X) => Some(Contact { pair: id, clearance: f64::NEG_INFINITY }),
                true => None,
            };
            match contact {
                Some(contact) if moves => found[lane] = Some(contact),
                Some(contact) => found.iter_mut().for_each(|f| *f = f.or(Some(contact))),
                None if open.lanes != 0 && n != DVec3::ZERO && scene.is_convex(id) => {
                    let (near, _) = scratch.level.run(Along {
                        scene,
                        pairs,
                        course: &scratch.course,
                        scratch: &mut scratch.sweep,
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
