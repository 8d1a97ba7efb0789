//! The placements worth aiming at, object by object, and how they are found.
//!
//! Of each object the relaxed problem has two trees of placements: those that floating hands reach from the start's placement, and
//! those from which they reach a goal's. Each draw lies between a member of one tree and a member of the other, and is tested
//! against both. What is in both trees connects start and goal; of the placements on the way, those at which the grasp
//! has to change are *bridges*: the object can be brought there by some grasps, and taken away by others. Where hands carry the
//! object from the start to the goal at once nothing is drawn: no placement between is needed for their sake.
//!
//! Only what is fixed in the world is in the way. Other objects are not, nor those that are at the same place in start and goal: a
//! path may move them away, so a placement that they block may still be needed. Where none ever moves, candidates that
//! aim at it fail, and it is aimed at less.

use crate::heuristic::placements::drawing::Resting;
use crate::heuristic::placements::floating_hand::{FloatingHands, HandScratch, Way};
use crate::planning_model::model::Model;
use crate::runtime::random::{Purpose, stream};
use bevy_ecs::prelude::Resource;
use foliate_components::Pose;
use foliate_components::graph::leaf::{Parameter, ParameterId};
use rand::RngExt;
use rayon::prelude::*;

/// Draws that are tested side by side; part of the answer.
pub(crate) const BATCH: u32 = 64;

/// Draws of an object at most.
const MOST_DRAWS: u32 = 1 << 17;

/// Members of a relaxed tree at most.
const MOST_MEMBERS: usize = 128;

/// Bridges of an object at most.
const MOST_BRIDGES: usize = 512;

/// Nothing is drawn while so many bridges are worth a try.
const ENOUGH: usize = 8;

/// A bridge is worth a try until it has been tried so often, or reached from both sides.
const PATIENCE: u32 = 24;

/// A suggested placement is tried so many times as often.
const SUGGESTED: f64 = 8.0;

/// Which of the trees of start and goal is extended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Start,
    Goal,
}

/// The placements worth aiming at.
#[derive(Clone, Debug, Default, Resource)]
pub struct PlacementPool {
    /// By object; nothing of those that need none. `None` before the pool was first asked for.
    pub(crate) objects: Option<Vec<ObjectPlacements>>,
    /// What the candidates of this step aim at.
    pub(crate) aims: Vec<Aim>,
}

/// A candidate, and what it aims at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    pub(crate) candidate: usize,
    pub(crate) object: usize,
    pub(crate) bridge: usize,
    pub(crate) side: Side,
}

/// Placements of one object.
#[derive(Clone, Debug)]
pub(crate) struct ObjectPlacements {
    pub(crate) object: u32,
    pub(crate) resting: Resting,
    pub(crate) hands: FloatingHands,
    /// By side: the relaxed trees.
    members: [Vec<Member>; 2],
    pub(crate) bridges: Vec<Bridge>,
    /// By side and grasp: candidates that were to grasp the object where it rests in start or goal.
    pub(crate) approaches: [Vec<u32>; 2],
    /// Draws so far.
    pub(crate) draws: u32,
    /// Whether placements are drawn: not where hands carry the object from start to goal at once.
    pub(crate) is_drawn: bool,
}

/// A placement in a relaxed tree.
#[derive(Clone, Debug)]
struct Member {
    X_WO: Pose,
    /// Grasps by which hands can hold it there.
    graspable: u64,
    /// The member next to the root, and the grasps by which the object gets from one to the other; none for the root.
    parent: Option<(usize, u64)>,
    is_between: bool,
}

/// A placement worth aiming at.
#[derive(Clone, Debug)]
pub(crate) struct Bridge {
    pub(crate) parameter: Parameter,
    /// Once a candidate has aimed at it.
    pub(crate) id: Option<ParameterId>,
    /// By side: grasps by which to set it down there.
    pub(crate) grasps: [u64; 2],
    suggested: bool,
    /// By side.
    pub(crate) tries: [u32; 2],
    pub(crate) succeeded: [u32; 2],
}

/// What is known of a draw.
struct Drawn {
    X_WO: Pose,
    graspable: u64,
    /// By side: the member that it was tested against, and the grasps by which it is reached from there.
    reached: [(usize, u64); 2],
}

impl Bridge {
    fn new(parameter: Parameter, grasps: [u64; 2], suggested: bool) -> Self {
        Self { parameter, id: None, grasps, suggested, tries: [0; 2], succeeded: [0; 2] }
    }

    fn is_fresh(&self) -> bool {
        let open = |side: usize| self.grasps[side] == 0 || self.succeeded[side] == 0;
        (open(0) || open(1)) && self.tries[0] + self.tries[1] < PATIENCE
    }

    /// How worthwhile it is to try once more from a side: less with every try and every success, more where the other side is there.
    pub(crate) fn weight(&self, side: Side) -> f64 {
        let (own, other) = (side as usize, 1 - side as usize);
        let base = if self.suggested { SUGGESTED } else { 1.0 };
        let tries = f64::from(self.tries[own]);
        let half_done = if self.succeeded[other] > 0 { 8.0 } else { 1.0 };
        base * half_done / ((1.0 + f64::from(self.succeeded[own]).powi(2)) * (1.0 + tries * tries / 64.0))
    }
}

impl ObjectPlacements {
    /// Placements of an object that rests at `starts` first and at `goals` last, with those that the problem suggests.
    pub(crate) fn new(model: &Model, object: u32, (starts, goals): (&[Pose], &[Pose])) -> Option<Self> {
        let hands = FloatingHands::of_object(model, object)?;
        let resting = Resting::of_object(model, object)?;
        let mut scratch = HandScratch::default();
        let mut rng = stream(0, Purpose::PLACEMENT, u64::from(object), u32::MAX);
        let mut member = |X_WO: &Pose| {
            let graspable = graspable(model, &hands, X_WO, &mut rng, &mut scratch);
            Member { X_WO: *X_WO, graspable, parent: None, is_between: true }
        };
        let members = [starts, goals].map(|poses| poses.iter().map(&mut member).collect::<Vec<_>>());
        let approaches = [0, 1].map(|_| vec![0; hands.grasps.len()]);
        let bridges = Vec::new();
        let mut new = Self { object, resting, hands, members, bridges, approaches, draws: 0, is_drawn: false };
        new.suggest(model, &mut scratch);
        // Nothing but another grasp makes a bridge.
        let has_choice = new.hands.grasps.len() > 1 && new.members.iter().all(|members| !members.is_empty());
        new.is_drawn = has_choice && !new.can_be_carried_at_once(model);
        (new.is_drawn || !new.bridges.is_empty()).then_some(new)
    }

    /// Takes the placements that the problem suggests into the pool.
    fn suggest(&mut self, model: &Model, scratch: &mut HandScratch) {
        let part = model.graph.objects[self.object as usize].part;
        let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
        let mut rng = stream(0, Purpose::PLACEMENT, u64::from(self.object), u32::MAX - 1);
        for (_, pose) in model.problem.suggestions.iter().filter(|(named, _)| *named == part) {
            let Some(X_WO) = self.resting.laid_down(pose, &mut X_WJ) else { continue };
            let mut grasps = graspable(model, &self.hands, &X_WO, &mut rng, scratch);
            if grasps == 0 {
                // The test has its faults (fingers that open, objects that move away): all may be tried.
                grasps = u64::MAX;
            }
            self.bridges.push(Bridge::new(self.resting.parameter(&X_WO), [grasps; 2], true));
        }
    }

    fn can_be_carried_at_once(&self, model: &Model) -> bool {
        let mut scratch = HandScratch::default();
        let [starts, goals] = &self.members;
        let pairs = starts.iter().flat_map(|start| goals.iter().map(move |goal| (start, goal)));
        let mut pairs = pairs.zip(0u32..);
        pairs.any(|((start, goal), number)| {
            if start.X_WO == goal.X_WO {
                return true;
            }
            let mut rng = stream(0, Purpose::PLACEMENT, u64::from(self.object), u32::MAX - 2 - number);
            let common = start.graspable & goal.graspable;
            // Three lifts: one that fails says little.
            (0..3).any(|_| {
                let way = self.way(model, (&start.X_WO, &goal.X_WO), &mut rng);
                self.hands.object_passes(model, &way, &mut scratch)
                    && self.carrying(model, common, &way, &mut rng, &mut scratch) != 0
            })
        })
    }

    /// By grasp by which hands can hold the object at a side's root: how many bridges that are worth a try want it.
    pub(crate) fn wanted_at_root(&self, side: Side) -> impl Iterator<Item = (usize, f64)> {
        let graspable = self.members[side as usize].iter().filter(|member| member.parent.is_none());
        let graspable = graspable.fold(0, |all, member| all | member.graspable);
        let wants = move |grasp: usize| {
            let wanting = self.bridges.iter().filter(|b| b.is_fresh() && b.grasps[side as usize] & 1 << grasp != 0);
            (grasp, wanting.count() as f64)
        };
        bits(graspable).map(wants)
    }

    /// About how many bytes it takes.
    pub(crate) fn bytes(&self, model: &Model) -> u64 {
        let members = self.members.iter().map(|members| size_of_val(&**members)).sum::<usize>();
        (members + size_of_val(&*self.bridges)) as u64 + self.hands.bytes(model)
    }

    /// Whether more draws are wanted.
    pub(crate) fn wants_draws(&self) -> bool {
        self.is_drawn
            && self.draws < MOST_DRAWS
            && self.bridges.len() < MOST_BRIDGES
            && self.bridges.iter().filter(|bridge| bridge.is_fresh()).count() < ENOUGH
    }

    /// Draws and tests a batch.
    pub(crate) fn draw_batch(&mut self, model: &Model, seed: u64) {
        let (first, here) = (self.draws, &*self);
        let draw = |scratch: &mut HandScratch, number: u32| {
            let mut rng = stream(seed, Purpose::PLACEMENT, u64::from(here.object), first + number);
            here.draw(model, &mut rng, scratch)
        };
        let drawn: Vec<Option<Drawn>> = (0..BATCH)
            .into_par_iter()
            .map_init(HandScratch::default, |scratch, number| draw(scratch, number))
            .collect();
        self.draws += BATCH;
        for drawn in drawn.into_iter().flatten() {
            self.add(&drawn);
        }
    }

    fn draw(&self, model: &Model, rng: &mut impl RngExt, scratch: &mut HandScratch) -> Option<Drawn> {
        let ends = [0, 1].map(|side| match rng.random::<bool>() {
            true => 0,
            false => rng.random_range(0..self.members[side].len()),
        });
        let [a, b] = [0, 1].map(|side| &self.members[side][ends[side]]);
        let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
        let X_WO = self.resting.draw((&a.X_WO, &b.X_WO), rng, &mut X_WJ)?;
        if !self.hands.object_is_free(model, &X_WO, scratch) {
            return None;
        }
        let ways = [a, b].map(|end| self.way(model, (&end.X_WO, &X_WO), rng));
        let passes = [0, 1].map(|side| self.hands.object_passes(model, &ways[side], scratch));
        // Where a tree takes no more members only what connects both is of use.
        let takes = |side: usize| self.members[side].len() < MOST_MEMBERS;
        if !(passes[0] && passes[1] || [0, 1].into_iter().any(|side| passes[side] && takes(side))) {
            return None;
        }
        let graspable = graspable(model, &self.hands, &X_WO, rng, scratch);
        let mut reached = [(0, 0); 2];
        for (side, end) in [a, b].into_iter().enumerate() {
            let grasps = if passes[side] { graspable & end.graspable } else { 0 };
            reached[side] = (ends[side], self.carrying(model, grasps, &ways[side], rng, scratch));
        }
        (reached[0].1 | reached[1].1 != 0).then_some(Drawn { X_WO, graspable, reached })
    }

    /// A way from one placement to another, as high as it may be drawn.
    fn way(&self, model: &Model, (from, to): (&Pose, &Pose), rng: &mut impl RngExt) -> Way {
        let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
        let high = rng.random::<f64>().powi(2) * from.translation.distance(to.translation);
        let lift = self.resting.normal(from, &mut X_WJ) * (high + model.problem.graph.preplacement_distance);
        Way::new(from, to, lift)
    }

    /// The grasps, of `grasps`, by which hands are free along a way of the object.
    fn carrying(&self, model: &Model, grasps: u64, way: &Way, rng: &mut impl RngExt, scratch: &mut HandScratch) -> u64 {
        let turned = bits(grasps).map(|grasp| (grasp, self.hands.draw_turn(grasp, rng)));
        self.hands.carrying(model, turned, way, scratch)
    }

    fn add(&mut self, drawn: &Drawn) {
        let [by_start, by_goal] = drawn.reached.map(|(_, grasps)| grasps);
        let is_between = by_start != 0 && by_goal != 0;
        for side in [0, 1] {
            let (parent, grasps) = drawn.reached[side];
            if is_between {
                self.bridge_to(side, parent, held_on(by_start, by_goal).unwrap_or(grasps));
            }
            if grasps != 0 && self.members[side].len() < MOST_MEMBERS {
                let (X_WO, graspable) = (drawn.X_WO, drawn.graspable);
                let parent = Some((parent, grasps));
                self.members[side].push(Member { X_WO, graspable, parent, is_between });
            }
        }
        if is_between && held_on(by_start, by_goal).is_none() {
            self.add_bridge(&drawn.X_WO, [by_start, by_goal]);
        }
    }

    fn add_bridge(&mut self, X_WO: &Pose, grasps: [u64; 2]) {
        if self.bridges.len() < MOST_BRIDGES {
            self.bridges.push(Bridge::new(self.resting.parameter(X_WO), grasps, false));
        }
    }

    /// Start and goal are connected by a member of a tree: makes bridges of those between it and the root at which the grasp has to
    /// change. `onward` are the grasps by which the object leaves it.
    fn bridge_to(&mut self, side: usize, member: usize, mut onward: u64) {
        let mut at = member;
        while let Some((parent, grasps)) = self.members[side][at].parent.filter(|_| !self.members[side][at].is_between)
        {
            self.members[side][at].is_between = true;
            if held_on(grasps, onward).is_none() {
                let by_side = if side == 0 { [grasps, onward] } else { [onward, grasps] };
                let X_WO = self.members[side][at].X_WO;
                self.add_bridge(&X_WO, by_side);
            }
            (at, onward) = (parent, held_on(grasps, onward).unwrap_or(grasps));
        }
    }
}

/// The grasps by which hands can hold the object where it is.
fn graspable(
    model: &Model,
    hands: &FloatingHands,
    X_WO: &Pose,
    rng: &mut impl RngExt,
    scratch: &mut HandScratch,
) -> u64 {
    (0..hands.grasps.len())
        .filter(|&grasp| {
            let X_GH = hands.draw_turn(grasp, rng);
            hands.can_grasp(model, (grasp, &X_GH), X_WO, scratch)
        })
        .fold(0, |all, grasp| all | 1 << grasp)
}

/// The grasps by which the object arrives and leaves alike; nothing where the grasp has to change.
fn held_on(arriving: u64, leaving: u64) -> Option<u64> {
    Some(arriving & leaving).filter(|&both| both != 0)
}

/// The numbers of the bits that are set.
pub(crate) fn bits(of: u64) -> impl Iterator<Item = usize> {
    (0..64).filter(move |bit| of & 1 << bit != 0)
}
