//! A polyline is certified as its pieces are, one by one: what is called free is free at every sample, the prefix ends
//! before the first collision, and little is lost by asking for many pieces at once.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{always_colliding, at, bench, place, random_configuration};
use foliate_components::Pose;
use foliate_components::robot::Robot;
use foliate_kernels::collision::{
    CertificateSettings, CollisionScene, CollisionScratch, MotionVerdict, PairRule, PairSet, PolylineVerdict,
    certify_motion, certify_polyline, first_collision, min_clearance,
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
    size: usize,
}

impl Bench {
    /// Two arms over a table, the left one holding a box.
    fn new() -> Self {
        let robot = bench();
        let root = |part: &str| robot.parts[robot.part(part).unwrap().at()].root_joint.unwrap();
        let rigid_attachments = vec![
            RigidAttachment { object: root("box1"), carrier: robot.joint("robot/left_j6"), X_CO: at(0.23, 0.0, 0.0) },
            RigidAttachment { object: root("box2"), carrier: None, X_CO: at(0.8, -0.3, -0.114) },
        ];
        let ignored = always_colliding(&robot);
        let scene = CollisionScene::new(&robot, &PairRule { ignored: &ignored, ..PairRule::default() });
        let pairs = PairSet::new(&scene, &rigid_attachments, &[]);
        let (kinematics, size) = (Kinematics::new(&robot), robot.space.size());
        Self { robot, scene, kinematics, rigid_attachments, pairs, size }
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut X_WJ = vec![Pose::IDENTITY; self.kinematics.bodies()];
        self.kinematics.forward(q, &mut X_WJ);
        self.kinematics.carry(q, &self.rigid_attachments, &mut X_WJ);
        X_WJ
    }

    fn collides(&self, q: &[f64], scratch: &mut CollisionScratch) -> bool {
        first_collision(&self.scene, &self.poses(q), &self.pairs, 0.0, scratch).is_some()
    }

    /// A free start, and knots along a smooth curve from there on which both arms swing.
    fn curve(&self, rng: &mut ChaCha8Rng, pieces: usize, reach: f64, scratch: &mut CollisionScratch) -> Vec<f64> {
        let start = loop {
            let mut q = random_configuration(&self.robot, rng);
            for part in ["box1", "box2"] {
                place(&self.robot, &mut q, part, Pose::IDENTITY);
            }
            if !self.collides(&q, scratch) {
                break q;
            }
        };
        let dimension = self.robot.space.dimension();
        let is_arm = |v: usize| (1..8).contains(&v) || (10..17).contains(&v);
        let mut number = |v: usize| if is_arm(v) { rng.random_range(-1.0..1.0) } else { 0.0 };
        let mut wave = || (0..dimension).map(&mut number).collect::<Vec<f64>>();
        let (along, around) = (wave(), wave());
        let mut knots = Vec::new();
        for piece in 0..=pieces {
            let t = piece as f64 / pieces as f64;
            let v: Vec<f64> =
                along.iter().zip(&around).map(|(a, b)| reach * (a * t + 0.3 * b * (6.0 * t).sin())).collect();
            let mut q = start.clone();
            self.robot.space.integrate(&start, &v, &mut q);
            knots.extend(q);
        }
        knots
    }

    fn whole(&self, knots: &[f64], settings: &CertificateSettings, s: &mut CollisionScratch) -> PolylineVerdict {
        certify_polyline(&self.scene, &self.kinematics, &self.rigid_attachments, knots, &self.pairs, settings, s)
    }

    /// The first piece that is not free, each on its own.
    fn one_by_one(&self, knots: &[f64], settings: &CertificateSettings, s: &mut CollisionScratch) -> Option<usize> {
        (0..knots.len() / self.size - 1).find(|piece| {
            let (a, b) = knots[piece * self.size..(piece + 2) * self.size].split_at(self.size);
            let verdict =
                certify_motion(&self.scene, &self.kinematics, &self.rigid_attachments, a, b, &self.pairs, settings, s);
            !matches!(verdict, MotionVerdict::Free { .. })
        })
    }
}

#[test]
fn what_is_certified_is_free_and_what_is_free_is_certified() {
    let bench = Bench::new();
    let (mut rng, mut scratch) = (ChaCha8Rng::seed_from_u64(41), CollisionScratch::new());
    let settings = CertificateSettings::default();
    let (mut free, mut cut, mut disagree) = (0, 0, 0);
    let mut q = vec![0.0; bench.size];
    for round in 0..60 {
        let pieces = [2, 3, 40, 117][round % 4];
        let knots = bench.curve(&mut rng, pieces, [0.1, 0.4, 1.0][round % 3], &mut scratch);
        let verdict = bench.whole(&knots, &settings, &mut scratch);
        let (end, bound) = match verdict {
            PolylineVerdict::Free { min_clearance_lower_bound } => (pieces as f64, min_clearance_lower_bound),
            PolylineVerdict::FreeUntil { piece, t, .. } => (piece as f64 + t, 0.0),
        };
        for sample in 0..=500 {
            let along = end * f64::from(sample) / 500.0;
            let piece = (along as usize).min(pieces - 1);
            let (a, b) = knots[piece * bench.size..(piece + 2) * bench.size].split_at(bench.size);
            bench.robot.space.interpolate(a, b, along - piece as f64, &mut q);
            assert!(!bench.collides(&q, &mut scratch), "round {round}: certified up to {end}, in collision at {along}");
            if sample % 50 == 0 {
                let pairs = bench.pairs.moving_pairs(&bench.scene);
                let least = min_clearance(&bench.scene, &bench.poses(&q), pairs).unwrap().clearance;
                assert!(bound <= least + 2e-6, "round {round}: clearance {least} below the proved {bound}");
            }
        }
        let strict = CertificateSettings { all_or_nothing: true, ..settings };
        let is_free = matches!(verdict, PolylineVerdict::Free { .. });
        assert_eq!(is_free, matches!(bench.whole(&knots, &strict, &mut scratch), PolylineVerdict::Free { .. }));
        match (verdict, bench.one_by_one(&knots, &settings, &mut scratch)) {
            (PolylineVerdict::Free { .. }, None) => free += 1,
            (PolylineVerdict::FreeUntil { piece, t, .. }, Some(blocked)) => {
                cut += 1;
                let lost = blocked as f64 + 1.0 - (piece as f64 + t);
                assert!(lost <= 1.0 + 0.01 * pieces as f64, "round {round}: {lost} pieces of {pieces} lost");
            }
            _ => disagree += 1,
        }
    }
    println!("{free} free, {cut} cut, {disagree} decided otherwise piece by piece");
    assert!(free >= 15 && cut >= 15, "the test sees both kinds: {free} free, {cut} cut");
    assert!(disagree <= 1, "{disagree}");
}

#[test]
fn a_coarse_prefix_is_a_prefix() {
    let bench = Bench::new();
    let (mut rng, mut scratch) = (ChaCha8Rng::seed_from_u64(42), CollisionScratch::new());
    let fine = CertificateSettings { start_is_free: true, ..CertificateSettings::default() };
    let coarse = CertificateSettings { prefix_resolution: 0.125, ..fine };
    let end = |verdict| match verdict {
        PolylineVerdict::Free { .. } => f64::INFINITY,
        PolylineVerdict::FreeUntil { piece, t, .. } => piece as f64 + t,
    };
    let mut cut = 0;
    for _ in 0..30 {
        let knots = bench.curve(&mut rng, 64, 1.0, &mut scratch);
        let known = end(bench.whole(&knots, &fine, &mut scratch));
        let (one, two) =
            (bench.whole(&knots, &coarse, &mut scratch), bench.whole(&knots, &coarse, &mut CollisionScratch::new()));
        assert_eq!(one, two, "the answer depends on nothing but the question");
        assert!(end(one) <= known + 0.3, "{one:?} reaches beyond {known}");
        if known.is_finite() {
            cut += 1;
            assert!(end(one) >= known - 0.25 * 64.0, "{one:?} loses too much of {known}");
        }
    }
    assert!(cut >= 10, "{cut}");
}

#[test]
fn hostile_polylines_end_refused() {
    let bench = Bench::new();
    let (mut rng, mut scratch) = (ChaCha8Rng::seed_from_u64(43), CollisionScratch::new());
    let settings = CertificateSettings::default();
    let knots = bench.curve(&mut rng, 8, 0.1, &mut scratch);
    for bad in [f64::NAN, f64::INFINITY, 1e308, -1e200] {
        let mut knots = knots.clone();
        knots[5 * bench.size + 2] = bad;
        assert!(matches!(bench.whole(&knots, &settings, &mut scratch), PolylineVerdict::FreeUntil { .. }), "{bad}");
    }
    let one_knot = &knots[..bench.size];
    assert!(matches!(bench.whole(one_knot, &settings, &mut scratch), PolylineVerdict::Free { .. }));
    let few = CertificateSettings { max_samples: 3, ..settings };
    let verdict = bench.whole(&knots, &few, &mut scratch);
    assert!(matches!(verdict, PolylineVerdict::FreeUntil { .. }), "{verdict:?} with three samples");
}

/// Prints what a polyline costs; run with `--release --nocapture` to read it.
#[test]
fn costs() {
    let bench = Bench::new();
    let (mut rng, mut scratch) = (ChaCha8Rng::seed_from_u64(44), CollisionScratch::new());
    let settings = CertificateSettings { start_is_free: true, all_or_nothing: true, ..CertificateSettings::default() };
    for (name, pieces, reach) in [("0.3 rad a joint", 200, 0.3), ("1 rad a joint", 200, 1.0)] {
        let (mut together, mut apart, mut free) = (0.0, 0.0, 0);
        for _ in 0..60 {
            let knots = bench.curve(&mut rng, pieces, reach, &mut scratch);
            let begin = Instant::now();
            let verdict = bench.whole(&knots, &settings, &mut scratch);
            let middle = Instant::now();
            let blocked = bench.one_by_one(&knots, &settings, &mut scratch);
            if matches!(verdict, PolylineVerdict::Free { .. }) && blocked.is_none() {
                free += 1;
                together += (middle - begin).as_secs_f64();
                apart += middle.elapsed().as_secs_f64();
            }
        }
        let each = 1e6 / f64::from(free * pieces as i32);
        println!(
            "{name}: {free} free; per piece {:.2} µs together, {:.2} µs one by one",
            together * each,
            apart * each
        );
    }
}

#[test]
fn what_ends_a_proof_is_too_close_where_the_verdict_says_so() {
    let bench = Bench::new();
    let (mut rng, mut scratch) = (ChaCha8Rng::seed_from_u64(77), CollisionScratch::new());
    let (mut cut, mut touching) = (0, 0);
    for round in 0..60 {
        let pieces = [2, 3, 40][round % 3];
        let knots = bench.curve(&mut rng, pieces, 1.0, &mut scratch);
        for all_or_nothing in [false, true] {
            let settings = CertificateSettings { all_or_nothing, ..CertificateSettings::default() };
            let verdict = bench.whole(&knots, &settings, &mut scratch);
            let PolylineVerdict::FreeUntil { piece, t, blocked_by: Some(contact), blocked_at } = verdict else {
                continue;
            };
            assert!(blocked_at <= pieces as f64 && blocked_at >= piece as f64 + t, "{verdict:?}");
            let at = (blocked_at as usize).min(pieces - 1);
            let (a, b) = knots[at * bench.size..(at + 2) * bench.size].split_at(bench.size);
            let mut q = vec![0.0; bench.size];
            bench.robot.space.interpolate(a, b, blocked_at - at as f64, &mut q);
            let least = min_clearance(&bench.scene, &bench.poses(&q), std::iter::once(contact.pair)).unwrap().clearance;
            let keep = settings.clearance_guard;
            assert!(least <= keep + settings.resolution, "round {round}: {least} apart at {blocked_at}: {verdict:?}");
            touching += usize::from(least <= keep);
            cut += 1;
        }
    }
    assert!(cut > 40 && 10 * touching >= 9 * cut, "{touching} of {cut}");
}
