//! Bounds in lanes, single precision and all, call nothing apart that is not; verdicts in lanes are the verdicts.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{always_colliding, at, bench, compose, place, placed, random_configuration, random_geometry};
use collision_models::{random_pose, single};
use foliate_components::Pose;
use foliate_components::robot::{PartKind, Robot, RootJoint};
use foliate_kernels::collision::{
    CollisionScene, CollisionScratch, DistanceQuery, PairId, PairRule, PairSet, TestOrder, Verdicts, first_collision,
    first_collisions, open_to_bounds, pair_clearance,
};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use foliate_kernels::lanes::Level;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

struct Scene {
    robot: Robot,
    scene: CollisionScene,
    kinematics: Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
    pairs: PairSet,
}

impl Scene {
    fn new(robot: Robot, rigid_attachments: Vec<RigidAttachment>) -> Self {
        let ignored = always_colliding(&robot);
        let rule = PairRule { ignored: &ignored, ..PairRule::default() };
        let scene = CollisionScene::new(&robot, &rule);
        let pairs = PairSet::new(&scene, &rigid_attachments, &[]);
        let kinematics = Kinematics::new(&robot);
        Self { robot, scene, kinematics, rigid_attachments, pairs }
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut X_WJ = vec![Pose::IDENTITY; self.kinematics.bodies()];
        self.kinematics.forward(q, &mut X_WJ);
        self.kinematics.carry(q, &self.rigid_attachments, &mut X_WJ);
        X_WJ
    }

    /// Whatever bounds close is free; returns how many pairs they closed, and how many they could have.
    fn check_bounds(&self, block: &[Vec<f64>], guard: f64, scratch: &mut CollisionScratch) -> (usize, usize) {
        let (scene, pairs) = (&self.scene, &self.pairs);
        let flat = block.concat();
        let open = open_to_bounds(scene, &self.kinematics, &self.rigid_attachments, &flat, pairs, guard, scratch);
        let (mut closed, mut free) = (0, 0);
        for (lane, q) in block.iter().enumerate() {
            let X_WJ = self.poses(q);
            for id in pairs.moving_pairs(scene).chain(pairs.constant_pairs(scene)) {
                let needed = pairs.margin(id) + guard;
                let clearance =
                    pair_clearance(scene, id, &X_WJ, DistanceQuery::exact(needed), &mut DVec3::ZERO.clone());
                free += usize::from(clearance >= needed);
                // What does not move within the block stands in the first lane.
                let listed = |(pair, lanes): &(PairId, u16)| *pair == id && (lanes >> lane & 1 == 1 || *lanes == 1);
                if !open.iter().any(listed) {
                    closed += 1;
                    assert!(clearance >= needed, "{id:?} in lane {lane}: {clearance} m, needed {needed} m");
                }
            }
        }
        (closed, free)
    }

    fn check_verdicts(&self, block: &[Vec<f64>], guard: f64, scratch: &mut CollisionScratch) -> usize {
        let (scene, pairs, flat) = (&self.scene, &self.pairs, block.concat());
        let mut found = Vec::new();
        first_collisions(scene, &self.kinematics, &self.rigid_attachments, &flat, pairs, guard, scratch, &mut found);
        assert_eq!(found.len(), block.len());
        for (q, found) in block.iter().zip(&found) {
            let X_WJ = self.poses(q);
            let known = first_collision(scene, &X_WJ, pairs, guard, scratch);
            assert_eq!(found.is_some(), known.is_some(), "in lanes {found:?}, one at a time {known:?}");
            if let Some(contact) = found {
                let needed = pairs.margin(contact.pair) + guard;
                let clearance =
                    pair_clearance(scene, contact.pair, &X_WJ, DistanceQuery::exact(needed), &mut DVec3::ZERO.clone());
                assert!(
                    contact.clearance == f64::NEG_INFINITY || clearance < needed + 1e-9,
                    "{contact:?}: {clearance}"
                );
            }
        }
        found.iter().flatten().count()
    }
}

fn levels() -> Vec<Level> {
    Level::available()
}

/// Shapes of all kinds adrift around a fixed one.
fn debris(rng: &mut ChaCha8Rng, scale: f64) -> Robot {
    let parts: Vec<_> = (0..8)
        .map(|number| {
            let shapes = (0..1 + number % 3).map(|_| (random_pose(rng, 0.1), random_geometry(rng, number % 5)));
            (single(shapes.collect()), number)
        })
        .collect();
    let placed: Vec<_> = parts
        .iter()
        .map(|(model, number)| {
            let (kind, root) = match number {
                0 => (PartKind::Environment, RootJoint::Fixed),
                _ => (PartKind::Object, RootJoint::FreeFlyer),
            };
            let mut part = placed(&format!("part{number}"), kind, root, at(scale, -scale, 0.1));
            part.root_bounds = vec![(-scale, scale); 3];
            (model, part)
        })
        .collect();
    compose(&placed)
}

fn adrift(robot: &Robot, rng: &mut ChaCha8Rng, around: DVec3) -> Vec<f64> {
    let mut q = robot.space.neutral();
    for number in 1..8 {
        let mut pose = random_pose(rng, 0.6);
        pose.translation += around;
        place(robot, &mut q, &format!("part{number}"), pose);
    }
    q
}

#[test]
fn what_bounds_close_is_free_among_shapes_of_all_kinds() {
    for level in levels() {
        let mut rng = ChaCha8Rng::seed_from_u64(91);
        let (mut closed, mut free) = (0, 0);
        for round in 0..12 {
            // Far from the origin single precision has fewer digits.
            let around = DVec3::new([0.0, 3.0, 40.0][round % 3], 0.0, 0.0);
            let bench = Scene::new(debris(&mut rng, 50.0), Vec::new());
            let mut scratch = CollisionScratch::at_level(level);
            for guard in [0.0, 1e-4, 0.02] {
                let block: Vec<_> = (0..16).map(|_| adrift(&bench.robot, &mut rng, around)).collect();
                let (c, f) = bench.check_bounds(&block, guard, &mut scratch);
                (closed, free) = (closed + c, free + f);
            }
        }
        println!("{level}: bounds close {closed} of {free} pairs that are free");
        assert!(closed as f64 > 0.75 * free as f64, "{level}: {closed} of {free}");
    }
}

/// Random configurations, and sixteen along a short motion of one arm.
fn blocks(bench: &Scene, rng: &mut ChaCha8Rng) -> [Vec<Vec<f64>>; 2] {
    let mut draw = || {
        let mut q = random_configuration(&bench.robot, rng);
        place(&bench.robot, &mut q, "box1", at(0.8, 0.3, -0.114));
        place(&bench.robot, &mut q, "box2", at(0.8, -0.3, -0.114));
        q
    };
    let mut random: Vec<_> = (0..16).map(|_| draw()).collect();
    let is_free = |q: &Vec<f64>| {
        first_collision(&bench.scene, &bench.poses(q), &bench.pairs, 1e-5, &mut CollisionScratch::new()).is_none()
    };
    random[0] = std::iter::repeat_with(draw).take(1000).find(is_free).expect("one of many is free");
    let mut end = random[0].clone();
    for value in &mut end[1..8] {
        *value += rng.random_range(-0.4..0.4);
    }
    let along = (0..16).map(|i| {
        let mut q = random[0].clone();
        bench.robot.space.interpolate(&random[0], &end, (f64::from(i) + 0.5) / 16.0, &mut q);
        q
    });
    let along = along.collect();
    [random, along]
}

#[test]
fn verdicts_in_lanes_are_the_verdicts() {
    for level in levels() {
        for held in [false, true] {
            let robot = bench();
            let root = |part: &str| robot.parts[robot.part(part).unwrap().at()].root_joint.unwrap();
            let rigid_attachments = match held {
                false => Vec::new(),
                true => vec![RigidAttachment {
                    object: root("box1"),
                    carrier: robot.joint("robot/left_j6"),
                    X_CO: at(0.23, 0.0, 0.0),
                }],
            };
            let bench = Scene::new(robot, rigid_attachments);
            let mut rng = ChaCha8Rng::seed_from_u64(92);
            let mut scratch = CollisionScratch::at_level(level);
            let (mut colliding, mut asked) = (0, 0);
            for _ in 0..60 {
                for block in blocks(&bench, &mut rng) {
                    colliding += bench.check_verdicts(&block, 1e-5, &mut scratch);
                    asked += block.len();
                    bench.check_bounds(&block, 1e-5, &mut scratch);
                }
            }
            println!("{level}, held {held}: {colliding} of {asked} in collision");
            assert!(colliding > 100 && colliding < asked - 100);
        }
    }
}

/// Rows of unequal length, some of none, some longer than there are lanes: of each the first configuration that collides.
#[test]
fn of_a_row_the_first_collision_is_found() {
    for level in levels() {
        let bench = Scene::new(bench(), Vec::new());
        let Scene { scene, kinematics, rigid_attachments, pairs, .. } = &bench;
        let verdicts = Verdicts { scene, kinematics, rigid_attachments, pairs, guard: 1e-5 };
        let mut rng = ChaCha8Rng::seed_from_u64(95);
        let mut scratch = CollisionScratch::at_level(level);
        let (mut blocked, mut later, mut free) = (0, 0, 0);
        for _ in 0..30 {
            let all: Vec<_> = (0..3).flat_map(|_| blocks(&bench, &mut rng)).flatten().collect();
            let mut ends = Vec::new();
            while ends.last().is_none_or(|&end| end < all.len()) {
                let longest = if rng.random_bool(0.1) { 40 } else { 6 };
                ends.push((ends.last().copied().unwrap_or(0) + rng.random_range(0..longest)).min(all.len()));
            }
            let mut found = Vec::new();
            verdicts.first_in_rows(&all.concat(), &ends, &mut scratch, &mut found);
            assert_eq!(found.len(), ends.len());
            for (row, found) in found.iter().enumerate() {
                let row = row.checked_sub(1).map_or(0, |before| ends[before])..ends[row];
                let collides = |q: &Vec<f64>| {
                    first_collision(scene, &bench.poses(q), pairs, 1e-5, &mut CollisionScratch::new()).is_some()
                };
                let known = all[row.clone()].iter().position(collides);
                assert_eq!(found.map(|(place, _)| place), known, "{level}: row {row:?}");
                blocked += usize::from(known.is_some());
                later += usize::from(known.is_some_and(|place| place > 0));
                free += usize::from(known.is_none() && !row.is_empty());
            }
        }
        println!("{level}: {blocked} rows are blocked, {later} of them behind their first, {free} are free");
        assert!(blocked > 50 && later > 10 && free > 50, "{blocked}, {later}, {free}");
    }
}

/// Whatever collided before: groups that did are tested first.
#[test]
fn of_a_motion_the_first_sample_that_collides_is_found() {
    for level in levels() {
        let bench = Scene::new(bench(), Vec::new());
        let Scene { robot, scene, kinematics, rigid_attachments, pairs } = &bench;
        let verdicts = Verdicts { scene, kinematics, rigid_attachments, pairs, guard: 1e-5 };
        let mut rng = ChaCha8Rng::seed_from_u64(97);
        let (mut scratch, mut order) = (CollisionScratch::at_level(level), TestOrder::default());
        let (mut at_once, mut later, mut free) = (0, 0, 0);
        for round in 0..150 {
            let [random, _] = blocks(&bench, &mut rng);
            let mut to = random[0].clone();
            for value in &mut to[1..8] {
                *value += rng.random_range(-2.0..2.0);
            }
            let count = 1 + round % 16;
            let samples = (1..=count).map(|number| {
                let mut q = to.clone();
                robot.space.interpolate(&random[0], &to, number as f64 / count as f64, &mut q);
                q
            });
            let samples: Vec<_> = samples.collect();
            let collides = |q: &Vec<f64>| {
                first_collision(scene, &bench.poses(q), pairs, 1e-5, &mut CollisionScratch::new()).is_some()
            };
            let known = samples.iter().position(collides);
            for order in [&mut TestOrder::default(), &mut order] {
                let motion = [random[0].clone(), samples.concat()].concat();
                let found = verdicts.first_on_motion(&motion, order, &mut scratch);
                assert_eq!(found.map(|(sample, _)| sample), known, "{level}: motion {round}");
                if let Some((sample, pair)) = found {
                    let (X_WJ, mut hint) = (bench.poses(&samples[sample]), DVec3::ZERO);
                    let clearance = pair_clearance(scene, pair, &X_WJ, DistanceQuery::exact(1.0), &mut hint);
                    assert!(clearance < pairs.margin(pair) + 2e-5, "{level}: motion {round}, {clearance}");
                }
            }
            match known {
                Some(0) => at_once += 1,
                Some(_) => later += 1,
                None => free += 1,
            }
        }
        println!("{level}: {at_once} motions are blocked at once, {later} later, {free} are free");
        assert!(at_once > 5 && later > 20 && free > 20, "{at_once}, {later}, {free}");
        let nowhere = blocks(&bench, &mut rng)[0][0].clone();
        assert_eq!(verdicts.first_on_motion(&nowhere, &mut order, &mut scratch), None);
    }
}

#[test]
fn verdicts_of_meshes_in_lanes_are_the_verdicts() {
    let mut rng = ChaCha8Rng::seed_from_u64(93);
    for _ in 0..10 {
        let bench = Scene::new(debris(&mut rng, 2.0), Vec::new());
        let mut scratch = CollisionScratch::new();
        let block: Vec<_> = (0..21).map(|_| adrift(&bench.robot, &mut rng, DVec3::ZERO)).collect();
        bench.check_verdicts(&block, 1e-5, &mut scratch);
        bench.check_verdicts(&block[..1], 1e-5, &mut scratch);
        bench.check_verdicts(&[], 1e-5, &mut scratch);
    }
}

#[test]
fn hostile_configurations_collide() {
    let bench = Scene::new(bench(), Vec::new());
    let mut scratch = CollisionScratch::new();
    let mut rng = ChaCha8Rng::seed_from_u64(94);
    let [_, good] = blocks(&bench, &mut rng);
    for bad in [f64::NAN, f64::INFINITY, -1e200] {
        let mut block = good.clone();
        block[5][2] = bad;
        let (mut found, flat) = (Vec::new(), block.concat());
        let (scene, pairs) = (&bench.scene, &bench.pairs);
        first_collisions(scene, &bench.kinematics, &[], &flat, pairs, 1e-5, &mut scratch, &mut found);
        assert!(found[5].is_some(), "{bad}");
    }
}
