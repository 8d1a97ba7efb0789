//! A hand without an arm: whether it collides where it holds an object, and while it carries the object from one place to another.
//!
//! The hand is what moves rigidly with the gripper, and what is beyond it. Its fingers are wide open where it takes the object, and closed
//! while it carries it; other joints beyond the gripper are as in the start. Only what is fixed in the
//! world, the object and the hand are tested, so that what is refused here is impossible for every arm as long as other objects
//! stay where they are; what passes may still be impossible.

use crate::planning_model::graph::attachment_order::is_beyond;
use crate::planning_model::model::Model;
use foliate_components::Pose;
use foliate_components::constraint::{Grasp, Mask};
use foliate_components::graph::{ConstraintId, ConstraintKind, Opening};
use foliate_components::pose::exp_so3;
use foliate_components::robot::JointIndex;
use foliate_kernels::collision::{CollisionScratch, PairSet, first_collision};
use foliate_kernels::kinematics::RigidAttachment;
use glam::DVec3;
use rand::RngExt;

/// Grasps of an object that are told apart.
pub(crate) const MOST_GRASPS: usize = 64;

/// Hands that are told apart: each has pair sets as long as the list of all pairs.
const MOST_HANDS: usize = 8;

/// Places between two placements at which an object that is carried is tested.
const PLACES: u32 = 15;

/// An object, and the hands that may hold it.
#[derive(Clone, Debug)]
pub(crate) struct FloatingHands {
    /// The object's free-flyer.
    root: JointIndex,
    /// The object against what is fixed in the world.
    object: PairSet,
    hands: Vec<Hand>,
    /// By number: grasps of handles on the object's root.
    pub(crate) grasps: Vec<FloatingGrasp>,
    /// Poses of all bodies in the start.
    X_WJ: Vec<Pose>,
    start: Vec<f64>,
}

#[derive(Clone, Debug)]
struct Hand {
    gripper: JointIndex,
    /// What moves with the gripper, and where it is in the gripper's body while the fingers are wide open.
    wide: Vec<(JointIndex, Pose)>,
    /// The hand against what is fixed in the world.
    world: PairSet,
    /// The hand against the object.
    object: PairSet,
}

/// A grasp of the object.
#[derive(Clone, Debug)]
pub(crate) struct FloatingGrasp {
    /// The grasp.
    pub(crate) constraint: ConstraintId,
    hand: usize,
    grasp: Grasp,
    /// What moves with the gripper, and where it is in the gripper's body while the fingers are closed on the handle.
    closed: Vec<(JointIndex, Pose)>,
    /// Whether hand and object are free of each other, where the grasp leaves nothing free.
    is_free: Option<bool>,
}

/// Buffers of one thread.
#[derive(Default)]
pub(crate) struct HandScratch {
    X_WJ: Vec<Pose>,
    collision: Option<CollisionScratch>,
}

/// Places at which an object is tested that is carried from one pose to another.
pub(crate) struct Way([Pose; PLACES as usize]);

impl Way {
    /// Up by `lift`, straight on, and down.
    pub(crate) fn new(from: &Pose, to: &Pose, lift: DVec3) -> Self {
        // Places in the middle first: they are blocked most often.
        Self(std::array::from_fn(|place| {
            let t = reversed_bits(place as u32 + 1);
            let up = lift * (4.0 * t.min(1.0 - t)).min(1.0);
            let X_WO = from.translation.lerp(to.translation, t) + up;
            Pose::from_parts(X_WO, from.rotation.slerp(to.rotation, t).normalize())
        }))
    }
}

impl FloatingHands {
    /// About how many bytes they take: pair sets, and poses of bodies by grasp.
    pub(crate) fn bytes(&self, model: &Model) -> u64 {
        let pair_sets = 1 + 2 * self.hands.len() as u64;
        let poses = self.hands.iter().map(|hand| hand.wide.len()).sum::<usize>()
            + self.grasps.iter().map(|grasp| grasp.closed.len()).sum::<usize>();
        let poses = poses * size_of::<(JointIndex, Pose)>() + size_of_val(&*self.X_WJ) + size_of_val(&*self.start);
        pair_sets * model.bytes_of_pairs() + (poses + size_of_val(&*self.grasps)) as u64
    }

    /// The hands of the graph that may hold an object by its root; nothing where the object does not move or none can.
    pub(crate) fn of_object(model: &Model, object: u32) -> Option<Self> {
        let robot = &model.problem.robot;
        let root = model.objects()[object as usize].root?;
        let mut start = model.problem.start.clone();
        open_wide(model, &mut start);
        let X_WJ = model.kinematics.poses(&start);
        let part = robot.joints[root.at()].part;
        let is_object = |body: Option<JointIndex>| body.is_some_and(|b| robot.joints[b.at()].part == part);
        let pairs = model.pairs_between(|a, b| is_object(a) && b.is_none());
        let mut hands = Self { root, object: pairs, hands: Vec::new(), grasps: Vec::new(), X_WJ, start };
        for (number, record) in (0u32..).zip(&model.graph.constraints) {
            let (constraint, grasped) = (ConstraintId(number), record.kind);
            let Some(grasp) = model.grasp(constraint).filter(|_| matches!(grasped, ConstraintKind::Grasp { .. }))
            else {
                continue;
            };
            let Some(gripper) = grasp.gripper.joint.filter(|_| grasp.handle.joint == Some(root)) else { continue };
            let carried = |object: &crate::planning_model::objects::ObjectModel| {
                object.root.is_some_and(|root| robot.joints[root.at()].part == robot.joints[gripper.at()].part)
            };
            let is_known = hands.hands.iter().any(|hand| hand.gripper == gripper);
            let too_many = hands.grasps.len() == MOST_GRASPS || (!is_known && hands.hands.len() == MOST_HANDS);
            if too_many || model.objects().iter().any(carried) {
                continue;
            }
            let hand = hands.hand(model, gripper, is_object);
            let closed = hands.closed(model, grasped, gripper);
            hands.grasps.push(FloatingGrasp { constraint, hand, grasp: *grasp, closed, is_free: None });
        }
        let mut scratch = HandScratch::default();
        for number in 0..hands.grasps.len() {
            if hands.grasps[number].grasp.mask == Mask::ALL {
                let free = hands.is_apart(model, (number, &Pose::identity()), &Pose::identity(), &mut scratch);
                hands.grasps[number].is_free = Some(free);
            }
        }
        (!hands.grasps.is_empty()).then_some(hands)
    }

    /// The number of a gripper's hand.
    fn hand(&mut self, model: &Model, gripper: JointIndex, is_object: impl Fn(Option<JointIndex>) -> bool) -> usize {
        if let Some(known) = self.hands.iter().position(|hand| hand.gripper == gripper) {
            return known;
        }
        let robot = &model.problem.robot;
        let with = |body: Option<JointIndex>| is_beyond(robot, body, gripper);
        let wide = bodies_of_hand(model, gripper, &self.X_WJ);
        let world = model.pairs_between(|a, b| with(a) && b.is_none());
        let object = model.pairs_between(|a, b| with(a) && is_object(b));
        self.hands.push(Hand { gripper, wide, world, object });
        self.hands.len() - 1
    }

    /// Where the bodies of a hand are whose fingers are closed on a handle.
    fn closed(&self, model: &Model, grasp: ConstraintKind, gripper: JointIndex) -> Vec<(JointIndex, Pose)> {
        let mut q = self.start.clone();
        close_on(model, grasp, &mut q);
        let mut X_WJ = self.X_WJ.clone();
        model.kinematics.forward(&q, &mut X_WJ);
        bodies_of_hand(model, gripper, &X_WJ)
    }

    /// The most bodies that a hand has.
    pub(crate) fn bodies(&self) -> usize {
        self.hands.iter().map(|hand| hand.wide.len()).max().unwrap_or(0)
    }

    /// Whether the object collides with what is fixed in the world.
    pub(crate) fn object_is_free(&self, model: &Model, X_WO: &Pose, scratch: &mut HandScratch) -> bool {
        self.place_object(model, X_WO, scratch);
        self.is_free(model, &self.object, scratch)
    }

    /// The pose of the handle in the gripper, drawn where the grasp leaves a turn free.
    pub(crate) fn draw_turn(&self, grasp: usize, rng: &mut impl RngExt) -> Pose {
        let free = self.grasps[grasp].grasp.mask.0;
        let turn = DVec3::from_array([3, 4, 5].map(|row| match free[row] {
            true => 0.0,
            false => rng.random_range(-std::f64::consts::PI..std::f64::consts::PI),
        }));
        Pose::from_parts(DVec3::ZERO, exp_so3(turn))
    }

    /// Whether the hand is free where it holds the object, and where it stands back from it.
    pub(crate) fn can_grasp(
        &self,
        model: &Model,
        (grasp, X_GH): (usize, &Pose),
        X_WO: &Pose,
        scratch: &mut HandScratch,
    ) -> bool {
        let known = self.grasps[grasp].is_free;
        if !known.unwrap_or_else(|| self.is_apart(model, (grasp, X_GH), X_WO, scratch)) {
            return false;
        }
        let standoff = Pose::from_translation(DVec3::X * self.grasps[grasp].grasp.standoff);
        let wide = &self.hands[self.grasps[grasp].hand].wide;
        [*X_GH, standoff * *X_GH].iter().all(|X_GH| self.hand_is_free(model, wide, (grasp, X_GH), X_WO, scratch))
    }

    /// Whether hand and object do not collide in a grasp and in front of it.
    fn is_apart(&self, model: &Model, (grasp, X_GH): (usize, &Pose), X_WO: &Pose, scratch: &mut HandScratch) -> bool {
        let standoff = Pose::from_translation(DVec3::X * self.grasps[grasp].grasp.standoff);
        self.place_object(model, X_WO, scratch);
        [*X_GH, standoff * *X_GH].iter().all(|X_GH| {
            let hand = &self.hands[self.grasps[grasp].hand];
            self.place_hand(&hand.wide, (grasp, X_GH), X_WO, scratch);
            self.is_free(model, &hand.object, scratch)
        })
    }

    /// Whether the object on its own is free at all places of a way.
    pub(crate) fn object_passes(&self, model: &Model, way: &Way, scratch: &mut HandScratch) -> bool {
        way.0.iter().all(|X_WO| self.object_is_free(model, X_WO, scratch))
    }

    /// Of some grasps, each with the pose of the handle in the gripper, those by which the hand is free all along a way of the object.
    pub(crate) fn carrying(
        &self,
        model: &Model,
        grasps: impl Iterator<Item = (usize, Pose)>,
        way: &Way,
        scratch: &mut HandScratch,
    ) -> u64 {
        let mut carries = |(grasp, X_GH): &(usize, Pose)| {
            let closed = &self.grasps[*grasp].closed;
            way.0.iter().all(|X_WO| self.hand_is_free(model, closed, (*grasp, X_GH), X_WO, scratch))
        };
        grasps.filter(&mut carries).fold(0, |all, (grasp, _)| all | 1 << grasp)
    }

    fn hand_is_free(
        &self,
        model: &Model,
        bodies: &[(JointIndex, Pose)],
        (grasp, X_GH): (usize, &Pose),
        X_WO: &Pose,
        scratch: &mut HandScratch,
    ) -> bool {
        if scratch.X_WJ.len() != self.X_WJ.len() {
            scratch.X_WJ.clone_from(&self.X_WJ);
        }
        self.place_hand(bodies, (grasp, X_GH), X_WO, scratch);
        self.is_free(model, &self.hands[self.grasps[grasp].hand].world, scratch)
    }

    fn place_object(&self, model: &Model, X_WO: &Pose, scratch: &mut HandScratch) {
        scratch.X_WJ.clone_from(&self.X_WJ);
        let placed = RigidAttachment { object: self.root, carrier: None, X_CO: *X_WO };
        model.kinematics.carry(&self.start, &[placed], &mut scratch.X_WJ);
    }

    fn place_hand(
        &self,
        bodies: &[(JointIndex, Pose)],
        (grasp, X_GH): (usize, &Pose),
        X_WO: &Pose,
        scratch: &mut HandScratch,
    ) {
        let grasp = &self.grasps[grasp].grasp;
        let X_WH = *X_WO * grasp.handle.joint_from_frame;
        let X_WG = X_WH * X_GH.inverse() * grasp.gripper.joint_from_frame.inverse();
        for (body, X_GB) in bodies {
            scratch.X_WJ[body.at()] = X_WG * *X_GB;
        }
    }

    fn is_free(&self, model: &Model, pairs: &PairSet, scratch: &mut HandScratch) -> bool {
        let collision = scratch.collision.get_or_insert_default();
        first_collision(&model.collision, &scratch.X_WJ, pairs, 0.0, collision).is_none()
    }
}

/// What moves with a gripper, and where it is in the gripper's body.
fn bodies_of_hand(model: &Model, gripper: JointIndex, X_WJ: &[Pose]) -> Vec<(JointIndex, Pose)> {
    let robot = &model.problem.robot;
    let X_GW = X_WJ[gripper.at()].inverse();
    let all = (0..robot.joints.len() as u32).map(JointIndex).filter(|&body| is_beyond(robot, Some(body), gripper));
    all.map(|body| (body, X_GW * X_WJ[body.at()])).collect()
}

/// Opens all hands wide.
fn open_wide(model: &Model, q: &mut [f64]) {
    for (hand, record) in (0u32..).zip(&model.problem.graph.hands) {
        model.finger_coordinates(hand).zip(record.at(0.0)).for_each(|(i, value)| q[i] = value);
    }
}

/// Closes the hand that makes a grasp on the handle.
fn close_on(model: &Model, grasp: ConstraintKind, q: &mut [f64]) {
    let ConstraintKind::Grasp { gripper, handle } = grasp else { return };
    for (hand, record) in (0u32..).zip(&model.problem.graph.hands) {
        if record.grippers.contains(&gripper) {
            for (finger, i) in (0u32..).zip(model.finger_coordinates(hand)) {
                let closed = model.finger_value(hand, finger, Opening::Closed { gripper, handle });
                q[i] = closed.unwrap_or(q[i]);
            }
        }
    }
}

/// Shares in (0, 1) by number: a half, quarters, eighths.
fn reversed_bits(number: u32) -> f64 {
    f64::from(number.reverse_bits()) / 2f64.powi(32)
}
