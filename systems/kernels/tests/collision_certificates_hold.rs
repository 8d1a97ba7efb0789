//! What is certified free is free at every sample, however dense; the same answer every time.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{always_colliding, at, bench, place, random_configuration};
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, Robot};
use foliate_kernels::collision::{
    CertificateSettings, CollisionScene, CollisionScratch, Contact, MotionVerdict, PairRule, PairSet, certify_motion,
    first_collision, min_clearance,
};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::time::Instant;

struct Bench {
    robot: Robot,
    scene: CollisionScene,
    kinematics: Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
    pairs: PairSet,
}

impl Bench {
    fn new(held: bool) -> Self {
        let robot = bench();
        let root = |part: &str| robot.parts[robot.part(part).unwrap().at()].root_joint.unwrap();
        let left = robot.joint("robot/left_j6");
        let (carrier, X_CO) = if held { (left, at(0.23, 0.0, 0.0)) } else { (None, at(0.8, 0.3, -0.114)) };
        let rigid_attachments = vec![
            RigidAttachment { object: root("box1"), carrier, X_CO },
            RigidAttachment { object: root("box2"), carrier: None, X_CO: at(0.8, -0.3, -0.114) },
        ];
        // What always overlaps is no subject of a test: those pairs go the way of an SRDF's.
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

    fn collision(&self, q: &[f64], guard: f64, scratch: &mut CollisionScratch) -> Option<Contact> {
        first_collision(&self.scene, &self.poses(q), &self.pairs, guard, scratch)
    }

    fn free_configuration(&self, rng: &mut ChaCha8Rng, scratch: &mut CollisionScratch) -> Vec<f64> {
        loop {
            let q = self.fingers(random_configuration(&self.robot, rng));
            if self.collision(&q, 1e-5, scratch).is_none() {
                return q;
            }
        }
    }

    fn fingers(&self, mut q: Vec<f64>) -> Vec<f64> {
        for part in ["box1", "box2"] {
            place(&self.robot, &mut q, part, Pose::IDENTITY);
        }
        q
    }

    /// A step of about `reach` radians on one arm, or both.
    fn step(&self, a: &[f64], reach: f64, both: bool, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let mut b = a.to_vec();
        let arms: &[usize] = if both { &[1, 10] } else { &[1] };
        let moves: Vec<f64> = (0..14).map(|_| rng.random_range(-1.0..1.0)).collect();
        let length = moves[..7 * arms.len()].iter().map(|x| x * x).sum::<f64>().sqrt();
        for (arm, &first) in arms.iter().enumerate() {
            for j in 0..7 {
                b[first + j] = (a[first + j] + moves[7 * arm + j] * reach / length).clamp(-3.0, 3.0);
            }
        }
        b
    }

    fn certify(&self, a: &[f64], b: &[f64], settings: &CertificateSettings, s: &mut CollisionScratch) -> MotionVerdict {
        certify_motion(&self.scene, &self.kinematics, &self.rigid_attachments, a, b, &self.pairs, settings, s)
    }
}

#[test]
fn dense_sampling_finds_nothing_in_a_certified_motion() {
    for held in [false, true] {
        let bench = Bench::new(held);
        let (moving, constant) =
            (bench.pairs.moving_pairs(&bench.scene).count(), bench.pairs.constant_pairs(&bench.scene).count());
        println!("held {held}: {} pairs, {moving} moving, {constant} constant", bench.scene.pairs().len());
        let mut rng = ChaCha8Rng::seed_from_u64(31);
        let mut scratch = CollisionScratch::new();
        let settings = CertificateSettings::default();
        let (mut free, mut refused, mut in_doubt, mut lost) = (0, 0, 0, 0.0_f64);
        let mut q = vec![0.0; bench.robot.space.size()];
        for round in 0..150 {
            let a = bench.free_configuration(&mut rng, &mut scratch);
            let b = bench.step(&a, [0.3, 1.0, 3.0][round % 3], round % 2 == 0, &mut rng);
            let verdict = bench.certify(&a, &b, &settings, &mut scratch);
            let (proved, bound) = match verdict {
                MotionVerdict::Free { min_clearance_lower_bound } => (1.0, min_clearance_lower_bound),
                MotionVerdict::FreeUntil { t, .. } => (t, 0.0),
            };
            let samples = 400;
            let mut first_hit = None;
            let mut least = f64::INFINITY;
            for i in 0..=samples {
                let t = f64::from(i) / f64::from(samples);
                bench.robot.space.interpolate(&a, &b, t, &mut q);
                let hit = bench.collision(&q, 0.0, &mut scratch).is_some();
                if hit && first_hit.is_none() {
                    first_hit = Some(t);
                }
                if hit {
                    assert!(t > proved, "certified up to {proved}, in collision at {t}");
                    break;
                }
                if i % 20 == 0 && proved >= 1.0 {
                    least = least.min(
                        min_clearance(&bench.scene, &bench.poses(&q), bench.pairs.moving_pairs(&bench.scene))
                            .unwrap()
                            .clearance,
                    );
                }
            }
            match (proved >= 1.0, first_hit) {
                (true, None) => {
                    free += 1;
                    assert!(bound <= least + 2e-6, "clearance {least} below the proved {bound}");
                }
                (false, Some(t)) => {
                    refused += 1;
                    lost = lost.max(t - proved);
                }
                (false, None) => in_doubt += 1,
                (true, Some(_)) => unreachable!("asserted above"),
            }
        }
        println!(
            "held {held}: {free} certified, {refused} refused rightly, {in_doubt} refused in doubt, prefix short by at most {lost:.4}"
        );
        assert!(in_doubt <= 3 && free > 30);
        assert!(lost < 0.01);
    }
}

#[test]
fn the_same_answer_every_time_and_with_any_scratch() {
    let bench = Bench::new(true);
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    let mut worn = CollisionScratch::new();
    for _ in 0..100 {
        let a = bench.free_configuration(&mut rng, &mut worn);
        let b = bench.step(&a, 1.5, true, &mut rng);
        for all_or_nothing in [false, true] {
            let settings = CertificateSettings { all_or_nothing, ..CertificateSettings::default() };
            let (one, two) = (
                bench.certify(&a, &b, &settings, &mut worn),
                bench.certify(&a, &b, &settings, &mut CollisionScratch::new()),
            );
            assert_eq!(one, two);
        }
    }
}

#[test]
fn scenes_and_pair_sets_are_shared_by_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<CollisionScene>();
    shared::<PairSet>();
}

#[test]
fn both_modes_agree_on_what_is_free() {
    let bench = Bench::new(false);
    let mut rng = ChaCha8Rng::seed_from_u64(33);
    let mut scratch = CollisionScratch::new();
    for _ in 0..200 {
        let a = bench.free_configuration(&mut rng, &mut scratch);
        let b = bench.step(&a, 1.0, false, &mut rng);
        let free = |settings: &CertificateSettings, s: &mut CollisionScratch| {
            matches!(bench.certify(&a, &b, settings, s), MotionVerdict::Free { .. })
        };
        let prefix = free(&CertificateSettings::default(), &mut scratch);
        let strict = CertificateSettings { all_or_nothing: true, ..CertificateSettings::default() };
        let known = CertificateSettings { start_is_free: true, ..CertificateSettings::default() };
        assert_eq!(prefix, free(&strict, &mut scratch));
        assert_eq!(prefix, free(&known, &mut scratch));
    }
}

#[test]
fn hostile_motions_end_refused() {
    let bench = Bench::new(false);
    let q = bench.fingers(bench.robot.space.neutral());
    let mut scratch = CollisionScratch::new();
    for bad in [f64::NAN, f64::INFINITY, 1e308, -1e200] {
        let mut to = q.clone();
        to[2] = bad;
        let verdict = bench.certify(&q, &to, &CertificateSettings::default(), &mut scratch);
        assert!(matches!(verdict, MotionVerdict::FreeUntil { .. }), "{bad}: {verdict:?}");
    }
}

#[test]
fn locked_joints_make_pairs_fixed() {
    let robot = bench();
    let locked: Vec<JointIndex> = (0..robot.joints.len() as u32)
        .map(JointIndex)
        .filter(|j| robot.joints[j.at()].name.contains("finger"))
        .collect();
    let free = CollisionScene::new(&robot, &PairRule::default());
    let scene = CollisionScene::new(&robot, &PairRule { locked: &locked, ..PairRule::default() });
    assert_eq!(free.fixed_pairs().count(), 0);
    // Per hand: the fingers against each other, and each of them against the two shapes of the hand.
    assert_eq!(scene.fixed_pairs().count(), 10);
    let pairs = PairSet::new(&scene, &[], &[]);
    assert_eq!(pairs.moving_pairs(&scene).count() + 10, scene.pairs().len());
}

/// Prints what a verdict and a certificate cost; run with `--release --nocapture` to read it.
#[test]
fn costs() {
    let bench = Bench::new(true);
    let mut rng = ChaCha8Rng::seed_from_u64(34);
    let mut scratch = CollisionScratch::new();
    let all: Vec<Vec<Pose>> =
        (0..1000).map(|_| bench.poses(&bench.fingers(random_configuration(&bench.robot, &mut rng)))).collect();
    let starts: Vec<Vec<f64>> = (0..400).map(|_| bench.free_configuration(&mut rng, &mut scratch)).collect();
    let free: Vec<Vec<Pose>> = starts.iter().map(|q| bench.poses(q)).collect();
    for (name, set) in [("random", &all), ("free", &free)] {
        let mut hits = 0;
        let mut each = f64::INFINITY;
        for _ in 0..5 {
            let begin = Instant::now();
            hits += set
                .iter()
                .filter(|X| first_collision(&bench.scene, X, &bench.pairs, 1e-5, &mut scratch).is_some())
                .count();
            each = each.min(begin.elapsed().as_nanos() as f64 / set.len() as f64);
        }
        println!("verdict, {name}: {each:.0} ns, {:.0} % in collision", 20.0 * hits as f64 / set.len() as f64);
    }
    for (name, both, reach) in
        [("one arm, 1 rad", false, 1.0), ("both arms, 1 rad", true, 1.0), ("both arms, 3 rad", true, 3.0)]
    {
        for all_or_nothing in [false, true] {
            let settings =
                CertificateSettings { all_or_nothing, start_is_free: true, ..CertificateSettings::default() };
            let motions: Vec<_> = starts.iter().map(|a| (a, bench.step(a, reach, both, &mut rng))).collect();
            let mut times: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
            for (a, b) in &motions {
                // The best of three: other programs share the machine.
                let mut run = || {
                    let begin = Instant::now();
                    let verdict = bench.certify(a, b, &settings, &mut scratch);
                    (begin.elapsed().as_nanos() as f64 / 1e3, matches!(verdict, MotionVerdict::Free { .. }))
                };
                let (first, free) = run();
                times[usize::from(free)].push(first.min(run().0).min(run().0));
            }
            for (what, mut times) in ["refused", "free"].into_iter().zip(times) {
                times.sort_by(f64::total_cmp);
                let quantile = |x: f64| times.get((x * times.len() as f64) as usize).copied().unwrap_or(f64::NAN);
                let mean = times.iter().sum::<f64>() / times.len() as f64;
                let mode = if all_or_nothing { "all or nothing" } else { "prefix" };
                println!(
                    "certify, {name}, {mode}, {what} ({}): mean {mean:.1} µs, median {:.1}, 90 % {:.1}, max {:.1}",
                    times.len(),
                    quantile(0.5),
                    quantile(0.9),
                    quantile(0.999)
                );
            }
        }
    }
}
