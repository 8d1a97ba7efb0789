//! Hands that open and close: which grippers have fingers, which bound of a finger is the open one, and how far the fingers close on a
//! handle.

use crate::planning_model::graph::attachment_order::{chains, grasp_of, is_beyond};
use crate::planning_model::graph::support_placement::relative_pose_residual;
use foliate_components::Pose;
use foliate_components::constraint::{Grasp, Mask};
use foliate_components::path::fingers;
use foliate_components::pose::exp_so3;
use foliate_components::problem::{Finger, Hand, Problem};
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, JointType, LinkIndex, Robot, Source};
use foliate_kernels::collision::convex::core::{Convex, Core};
use foliate_kernels::collision::scene::scene_solid::SceneSolid;
use foliate_kernels::collision::{CollisionScene, DistanceQuery, Solid, clearance};
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// How far fingers stay off what they hold, metres: contact, less what certificates need to prove that they do not collide.
pub const FINGER_GAP: f64 = 2e-4;

/// Residual at which a gripper holds a handle at the start, metres and radians.
const HOLDS: f64 = 1e-4;

/// How close to [`FINGER_GAP`] a closing hand comes, metres.
const NEARLY: f64 = 2e-6;

/// Steps of a closing hand at most.
const MOST_STEPS: usize = 200;
/// Places between pregrasp and grasp at which the width of the object is measured, at most.
const MOST_PLACES: f64 = 100.0;
/// Turns about a free axis of a grasp at which the width of the object is measured.
const TURNS: usize = 8;

/// By gripper and handle: of each finger of the hand the share of its way from open to shut, found when it is first asked for.
pub(crate) type FingerShares = HashMap<(GripperIndex, HandleIndex), OnceLock<Vec<f64>>>;

/// What distances of fingers are measured with.
pub(crate) type Tables<'t> = (&'t Problem, &'t Kinematics, &'t CollisionScene);

/// The hands of a problem: those that it names, and those that the structure of the robot has.
#[must_use]
pub(crate) fn complete(
    problem: &Problem,
    still: &[JointIndex],
    kinematics: &Kinematics,
    scene: &CollisionScene,
) -> Vec<Hand> {
    let (robot, options) = (&problem.robot, &problem.graph);
    let mut hands = options.hands.clone();
    let named = hands.len();
    for &gripper in &options.grippers {
        if hands[..named].iter().any(|hand| hand.grippers.contains(&gripper)) {
            continue;
        }
        let joints = fingers(robot, gripper);
        // Who locks a finger has chosen the opening.
        if joints.iter().any(|joint| options.locked.iter().any(|(locked, _)| locked == joint)) {
            continue;
        }
        let joints: Vec<_> = joints.into_iter().filter(|&joint| may_move(problem, still, joint)).collect();
        // A finger has one opening at a time, whichever gripper of its hand is to hold something.
        let shared = hands.iter_mut().find(|hand| hand.fingers.iter().any(|f| joints.contains(&f.joint)));
        match shared {
            Some(hand) => hand.grippers.push(gripper),
            None if joints.is_empty() => {}
            None => {
                let mut measured = Measurement::new(problem, kinematics, scene);
                let fingers = joints.iter().map(|&joint| measured.finger(gripper, joint)).collect();
                hands.push(Hand { grippers: vec![gripper], fingers });
            }
        }
    }
    for hand in &mut hands {
        let holds = holds_at_start(problem, kinematics, hand);
        for finger in &mut hand.fingers {
            let at_start = coordinate(robot, finger.joint).and_then(|q| problem.start.get(q).copied());
            let travel = at_start.filter(|_| !holds).unwrap_or(finger.open);
            finger.travel.get_or_insert(travel);
        }
    }
    hands
}

/// Whether a joint may be a finger: neither locked nor at rest, with bounds to open and shut.
fn may_move(problem: &Problem, still: &[JointIndex], joint: JointIndex) -> bool {
    let record = &problem.robot.joints[joint.at()];
    let rests = problem.graph.resting_joints.iter().any(|resting| resting.joint == joint);
    let is_bounded = record.lower[0].is_finite() && record.upper[0].is_finite();
    !still.contains(&joint) && !rests && is_bounded
}

/// The number of a joint in a configuration; none of one that follows another.
#[must_use]
pub(crate) fn coordinate(robot: &Robot, joint: JointIndex) -> Option<usize> {
    match robot.joints[joint.at()].source {
        Source::Coordinates { q, .. } => Some(q),
        Source::Follows { .. } => None,
    }
}

/// The grasps that a gripper may make.
fn grasps_of(problem: &Problem, gripper: GripperIndex) -> impl Iterator<Item = (HandleIndex, Grasp)> + '_ {
    let options = &problem.graph;
    let handles = options.objects.iter().flat_map(|object| object.handles.iter().copied());
    let allowed =
        move |&handle: &HandleIndex| options.grasps.as_ref().is_none_or(|table| table.contains(&(gripper, handle)));
    handles.filter(allowed).filter_map(move |handle| Some((handle, grasp_of(problem, gripper, handle).ok()?)))
}

/// Whether a hand must be open to travel: it holds something at the start, or has a grasp without a pregrasp beside which it could open.
fn holds_at_start(problem: &Problem, kinematics: &Kinematics, hand: &Hand) -> bool {
    if problem.start.len() != problem.robot.space.size() || problem.start.iter().any(|x| !x.is_finite()) {
        return true;
    }
    let X_WJ = kinematics.poses(&problem.start);
    let all = hand.grippers.iter().flat_map(|&gripper| grasps_of(problem, gripper));
    all.into_iter()
        .any(|(_, grasp)| grasp.standoff <= 0.0 || relative_pose_residual(&grasp.constraint(), &X_WJ) <= HOLDS)
}

/// A table of all grasps of hands with fingers, none measured yet.
#[must_use]
pub(crate) fn shares(problem: &Problem) -> FingerShares {
    let hands = problem.graph.hands.iter().filter(|hand| !hand.fingers.is_empty());
    let grippers = hands.flat_map(|hand| hand.grippers.iter().copied());
    let grasps = grippers.flat_map(|gripper| grasps_of(problem, gripper).map(move |(handle, _)| (gripper, handle)));
    grasps.map(|grasp| (grasp, OnceLock::new())).collect()
}

/// How far each finger of a hand has closed on a handle, as a share of its way from open to shut: until it is [`FINGER_GAP`] from the body of
/// the handle or from another finger, or wholly shut. Where the grasp leaves a turn free, where that is so first for any turn.
#[must_use]
pub(crate) fn closing(tables: Tables<'_>, hand: &Hand, grasp: (GripperIndex, HandleIndex)) -> Vec<f64> {
    narrowed(tables, hand, grasp, (0.0, FINGER_GAP))
}

/// As [`closing`], for fingers that stay `clearance` metres off all along the way from the pregrasp to the grasp.
#[must_use]
pub(crate) fn ready(
    tables: Tables<'_>,
    hand: &Hand,
    (gripper, handle): (GripperIndex, HandleIndex),
    clearance: f64,
) -> Vec<f64> {
    let standoff = grasp_of(tables.0, gripper, handle).map_or(0.0, |grasp| grasp.standoff);
    narrowed(tables, hand, (gripper, handle), (standoff, clearance.max(FINGER_GAP)))
}

/// How far fingers may close that stay `gap` metres off, where the handle is anywhere up to `standoff` metres ahead of the gripper.
fn narrowed(
    (problem, kinematics, scene): Tables<'_>,
    hand: &Hand,
    (gripper, handle): (GripperIndex, HandleIndex),
    (standoff, gap): (f64, f64),
) -> Vec<f64> {
    let mut least = vec![1.0; hand.fingers.len()];
    let Ok(grasp) = grasp_of(problem, gripper, handle) else { return least };
    let mut measurement = Measurement::new(problem, kinematics, scene);
    let pairs = measurement.finger_pairs(hand, handle);
    let steps = (standoff / gap).ceil().clamp(0.0, MOST_PLACES);
    let ahead = (0..=steps as usize).map(|step| standoff * step as f64 / steps.max(1.0));
    let turns = free_turns(grasp.mask);
    let places = ahead.flat_map(|ahead| turns.iter().map(move |turn| Pose::from_translation(DVec3::X * ahead) * *turn));
    for X_GH in places {
        let shares = measurement.closing_at(hand, &grasp, &pairs, (X_GH, gap));
        least.iter_mut().zip(shares).for_each(|(least, share)| *least = least.min(share));
    }
    least
}

/// Measures distances of fingers, at the start of a problem with some joints elsewhere.
struct Measurement<'a> {
    problem: &'a Problem,
    kinematics: &'a Kinematics,
    scene: &'a CollisionScene,
    q: Vec<f64>,
    X_WJ: Vec<Pose>,
}

impl<'a> Measurement<'a> {
    fn new(problem: &'a Problem, kinematics: &'a Kinematics, scene: &'a CollisionScene) -> Self {
        let space = &problem.robot.space;
        let is_whole = problem.start.len() == space.size() && problem.start.iter().all(|x| x.is_finite());
        let q = if is_whole { problem.start.clone() } else { space.neutral() };
        let X_WJ = vec![Pose::identity(); kinematics.bodies()];
        Self { problem, kinematics, scene, q, X_WJ }
    }

    /// Sets a joint and moves the bodies.
    fn set(&mut self, joints: impl Iterator<Item = (JointIndex, f64)>) {
        for (joint, value) in joints {
            if let Some(q) = coordinate(&self.problem.robot, joint) {
                self.q[q] = value;
            }
        }
        self.kinematics.forward(&self.q, &mut self.X_WJ);
    }

    /// A finger with its open bound: the one at which what it moves is farther from the gripper's frame. Documents may know better:
    /// a named configuration of the robot called `open`.
    fn finger(&mut self, gripper: GripperIndex, joint: JointIndex) -> Finger {
        let record = &self.problem.robot.joints[joint.at()];
        let (low, high) = (record.lower[0], record.upper[0]);
        let told = |name: &str| {
            let part = &self.problem.robot.parts[record.part.at()];
            let own = record.name.rsplit('/').next().unwrap_or(&record.name);
            let states = part.group_states.iter().filter(|state| state.name.eq_ignore_ascii_case(name));
            let value = |(joint, value): &(String, f64)| (joint == own).then_some(*value);
            states.flat_map(|state| &state.values).find_map(value).filter(|v| (low..=high).contains(v))
        };
        let [open, closed] = [["open", "opened"], ["close", "closed"]].map(|names| names.into_iter().find_map(told));
        let before = self.q.clone();
        let [at_low, at_high] = [low, high].map(|value| {
            self.set(std::iter::once((joint, value)));
            self.distance_of(gripper, joint)
        });
        self.q = before;
        let (wide, shut) = if at_low > at_high { (low, high) } else { (high, low) };
        let open = open.filter(|open| closed != Some(*open)).unwrap_or(wide);
        let closed = closed.filter(|closed| *closed != open).unwrap_or(if open == shut { wide } else { shut });
        Finger { joint, open, closed, travel: None }
    }

    /// How far the shapes that a joint moves are from the origin of a gripper, metres; 0 without shapes.
    fn distance_of(&self, gripper: GripperIndex, joint: JointIndex) -> f64 {
        let robot = &self.problem.robot;
        let record = &robot.grippers[gripper.at()];
        let body = robot.links[record.link.at()].joint;
        let link = foliate_components::constraint::Frame::on_link(robot, record.link, &record.link_from_gripper);
        let X_WG = body.map_or(Pose::IDENTITY, |body| self.X_WJ[body.at()]) * link.joint_from_frame;
        let point = Solid::Convex(Convex { core: Core::Point, radius: 0.0 });
        let moved = self
            .scene
            .solids()
            .iter()
            .filter(|solid| is_beyond(robot, solid.body, joint) || self.follows(solid.body, joint));
        let distance = |solid: &SceneSolid| {
            let X_WS = solid.body.map_or(Pose::IDENTITY, |body| self.X_WJ[body.at()]) * solid.X_JS;
            clearance(&point, &X_WG, &solid.solid, &X_WS, DistanceQuery::exact(f64::INFINITY), &mut DVec3::ZERO.clone())
        };
        moved.map(distance).fold(f64::INFINITY, f64::min).min(1e3)
    }

    /// Whether a body moves with a joint that mimics another.
    fn follows(&self, body: Option<JointIndex>, leader: JointIndex) -> bool {
        let joints = &self.problem.robot.joints;
        let above = std::iter::successors(body, |body| joints[body.at()].parent);
        above
            .into_iter()
            .any(|joint| matches!(joints[joint.at()].source, Source::Follows { leader: l, .. } if l == leader))
    }

    /// Conservative advancement: the fingers close by as much as they cannot touch within, with the handle at `X_GH` in the gripper. All go
    /// on alike until one is within `gap` metres of something; its chain then stands still, and the others go on.
    fn closing_at(&mut self, hand: &Hand, grasp: &Grasp, pairs: &[FingerPair], (X_GH, gap): (Pose, f64)) -> Vec<f64> {
        let joints: Vec<_> = hand.fingers.iter().map(|finger| finger.joint).collect();
        let chains = chains(&self.problem.robot, &joints);
        let mut shares = vec![0.0; hand.fingers.len()];
        let mut moves = vec![true; hand.fingers.len()];
        for _ in 0..MOST_STEPS {
            let at = hand.fingers.iter().zip(&shares).map(|(finger, share)| (finger.joint, finger.at(*share)));
            self.set(at);
            let X_WG = grasp.gripper.joint.map_or(Pose::IDENTITY, |body| self.X_WJ[body.at()])
                * grasp.gripper.joint_from_frame;
            let X_WB = X_WG * X_GH * grasp.handle.joint_from_frame.inverse();
            let moving = (0..shares.len()).filter(|&finger| moves[finger]);
            let mut step = moving.map(|finger| 1.0 - shares[finger]).fold(f64::INFINITY, f64::min);
            let mut stopped = Vec::new();
            for pair in pairs {
                let speed: f64 =
                    pair.speeds.iter().zip(&moves).filter(|(_, moves)| **moves).map(|(speed, _)| speed).sum();
                if speed <= 0.0 {
                    continue;
                }
                let room = pair.clearance(self.scene, &self.X_WJ, X_WB, gap + step * speed) - gap;
                if room > NEARLY {
                    step = step.min(room / speed);
                } else {
                    stopped.extend((0..shares.len()).filter(|&finger| pair.speeds[finger] > 0.0));
                }
            }
            if stopped.is_empty() {
                shares.iter_mut().zip(&moves).filter(|(_, moves)| **moves).for_each(|(share, _)| *share += step);
            }
            let stops = |chain: &&Vec<usize>| chain.iter().any(|finger| stopped.contains(finger));
            chains.iter().filter(stops).flatten().for_each(|&finger| moves[finger] = false);
            // Compared so that NaN ends it.
            let goes_on = step > 0.0 && moves.contains(&true);
            if !goes_on {
                break;
            }
        }
        shares
    }

    /// How fast each finger moves points of a body at most while it closes, metres over its whole way.
    fn speeds(&self, hand: &Hand, body: Option<JointIndex>) -> Vec<f64> {
        let joints = &self.problem.robot.joints;
        let mut speeds = vec![0.0; hand.fingers.len()];
        for joint in std::iter::successors(body, |body| joints[body.at()].parent) {
            let (leader, factor) = match joints[joint.at()].source {
                Source::Coordinates { .. } => (joint, 1.0),
                Source::Follows { leader, multiplier, .. } => (leader, multiplier.abs()),
            };
            if let Some(finger) = hand.fingers.iter().position(|finger| finger.joint == leader) {
                let range = (hand.fingers[finger].open - hand.fingers[finger].closed).abs();
                speeds[finger] += range * factor * self.reach(joint);
            }
        }
        speeds
    }

    /// How far from its axis a joint moves points, metres per radian; 1 where it slides.
    fn reach(&self, joint: JointIndex) -> f64 {
        let robot = &self.problem.robot;
        if matches!(robot.joints[joint.at()].motion, JointType::Prismatic { .. }) {
            return 1.0;
        }
        let origin = self.X_WJ[joint.at()].translation;
        let moved = self.scene.solids().iter().filter(|solid| is_beyond(robot, solid.body, joint));
        let far = |solid: &SceneSolid| {
            let X_WB = solid.body.map_or(Pose::IDENTITY, |body| self.X_WJ[body.at()]);
            X_WB.transform_point(solid.ball.center).distance(origin) + solid.ball.radius
        };
        moved.map(far).fold(0.0, f64::max)
    }

    /// The tested pairs of a finger with the body of a handle, or with another finger.
    fn finger_pairs(&mut self, hand: &Hand, handle: HandleIndex) -> Vec<FingerPair> {
        let open: Vec<_> = hand.fingers.iter().map(|finger| (finger.joint, finger.open)).collect();
        self.set(open.into_iter());
        let robot = &self.problem.robot;
        let held = robot.handles[handle.at()].link;
        let is_held = |link: LinkIndex| {
            let (link, held) = (&robot.links[link.at()], &robot.links[held.at()]);
            link.part == held.part && link.joint == held.joint
        };
        let solids = self.scene.solids();
        let mut pairs = Vec::new();
        for pair in self.scene.pairs() {
            let shapes = [pair.first.at(), pair.second.at()];
            let speeds = shapes.map(|shape| self.speeds(hand, solids[shape].body));
            let [a, b] = shapes.map(|shape| is_held(solids[shape].link));
            let pair = |finger: usize, other: usize, holds: bool| FingerPair {
                finger: shapes[finger],
                other: shapes[other],
                holds,
                speeds: speeds[0].iter().zip(&speeds[1]).map(|(a, b)| a + b).collect(),
            };
            match [0, 1].map(|shape| speeds[shape].iter().any(|speed| *speed > 0.0)) {
                [true, true] => pairs.push(pair(0, 1, false)),
                [true, false] if b => pairs.push(pair(0, 1, true)),
                [false, true] if a => pairs.push(pair(1, 0, true)),
                _ => {}
            }
        }
        pairs
    }
}

/// Two shapes that may touch when a hand closes, by number.
struct FingerPair {
    finger: usize,
    other: usize,
    /// Whether the other one is of the body that is held, and not another finger.
    holds: bool,
    /// How fast each finger of the hand brings them closer at most, metres over its whole way from open to shut.
    speeds: Vec<f64>,
}

impl FingerPair {
    /// A lower bound of the distance, nearly exact, or at least `enough`, where the held body is at `X_WB`.
    fn clearance(&self, scene: &CollisionScene, X_WJ: &[Pose], X_WB: Pose, enough: f64) -> f64 {
        let [a, b] = [self.finger, self.other].map(|shape| &scene.solids()[shape]);
        let [X_WA, X_WF] = [a, b].map(|solid| solid.body.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]));
        let X_WO = if self.holds { X_WB } else { X_WF };
        let far = X_WA.transform_point(a.ball.center).distance(X_WO.transform_point(b.ball.center));
        let rough = far - a.ball.radius - b.ball.radius;
        if rough >= enough {
            return rough;
        }
        let query = DistanceQuery::exact(enough);
        clearance(&a.solid, &(X_WA * a.X_JS), &b.solid, &(X_WO * b.X_JS), query, &mut DVec3::ZERO.clone())
    }
}

/// Poses of a handle in a gripper that a grasp with this mask allows: turns about its axes that are free.
fn free_turns(mask: Mask) -> Vec<Pose> {
    let mut turns = vec![Pose::identity()];
    for (row, axis) in [(3, DVec3::X), (4, DVec3::Y), (5, DVec3::Z)] {
        if !mask.0[row] {
            let angles = (1..TURNS).map(|turn| TAU * turn as f64 / TURNS as f64);
            turns.extend(angles.map(|angle| Pose::from_rotation(exp_so3(axis * angle))));
        }
    }
    turns
}
