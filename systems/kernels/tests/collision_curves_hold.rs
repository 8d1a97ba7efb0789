//! A curve that is certified is free at every sample, with the clearance that is proved; the least clearance along it is found;
//! what bulges into an obstacle between free knots is refused; a path with blended corners costs about what its polyline does.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{
    always_colliding, at, bench, compose, cuboid, mover, place, placed, random_configuration, single,
};
use foliate_components::Pose;
use foliate_components::robot::configuration::Group;
use foliate_components::robot::{PartKind, Robot, RootJoint};
use foliate_kernels::collision::{
    CertificateSettings, CollisionScene, CollisionScratch, CurveVerdict, MinimumSettings, PairRule, PairSet,
    PolylineVerdict, certify_curve, certify_polyline, first_collision, min_clearance, minimum_clearance_on_curve,
};
use foliate_kernels::curve::HermiteCurve;
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::time::Instant;

struct World {
    robot: Robot,
    scene: CollisionScene,
    kinematics: Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
    pairs: PairSet,
    size: usize,
}

/// Knots, velocities and times.
#[derive(Clone, Default)]
struct Rows {
    knots: Vec<f64>,
    velocities: Vec<f64>,
    times: Vec<f64>,
}

impl Rows {
    fn curve(&self) -> HermiteCurve<'_> {
        HermiteCurve { knots: &self.knots, velocities: &self.velocities, times: &self.times }
    }

    fn push(&mut self, q: &[f64], velocity: &[f64], duration: f64) {
        self.knots.extend_from_slice(q);
        self.velocities.extend_from_slice(velocity);
        self.times.push(self.times.last().map_or(0.0, |time| time + duration));
    }
}

impl World {
    fn new(robot: Robot, rigid_attachments: Vec<RigidAttachment>) -> Self {
        let ignored = always_colliding(&robot);
        let scene = CollisionScene::new(&robot, &PairRule { ignored: &ignored, ..PairRule::default() });
        let pairs = PairSet::new(&scene, &rigid_attachments, &[]);
        let (kinematics, size) = (Kinematics::new(&robot), robot.space.size());
        Self { robot, scene, kinematics, rigid_attachments, pairs, size }
    }

    /// Two arms over a table, the left one holding a box.
    fn arms() -> Self {
        let robot = bench();
        let root = |part: &str| robot.parts[robot.part(part).unwrap().at()].root_joint.unwrap();
        let rigid_attachments = vec![
            RigidAttachment { object: root("box1"), carrier: robot.joint("robot/left_j6"), X_CO: at(0.23, 0.0, 0.0) },
            RigidAttachment { object: root("box2"), carrier: None, X_CO: at(0.8, -0.3, -0.114) },
        ];
        Self::new(robot, rigid_attachments)
    }

    /// Planar and free roots, followers, lengths.
    fn mover() -> Self {
        Self::new(mover(), Vec::new())
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut X_WJ = vec![Pose::IDENTITY; self.kinematics.bodies()];
        self.kinematics.forward(q, &mut X_WJ);
        self.kinematics.carry(q, &self.rigid_attachments, &mut X_WJ);
        X_WJ
    }

    fn collides(&self, q: &[f64]) -> bool {
        first_collision(&self.scene, &self.poses(q), &self.pairs, 0.0, &mut CollisionScratch::new()).is_some()
    }

    fn free_start(&self, rng: &mut ChaCha8Rng) -> Vec<f64> {
        loop {
            let mut q = random_configuration(&self.robot, rng);
            for part in ["box1", "box2"].into_iter().filter(|part| self.robot.part(part).is_some()) {
                place(&self.robot, &mut q, part, Pose::IDENTITY);
            }
            if !self.collides(&q) {
                return q;
            }
        }
    }

    /// A row of numbers in [−reach, reach] for coordinates that move, 0 for those of boxes and fingers.
    fn drawn(&self, rng: &mut ChaCha8Rng, reach: f64) -> Vec<f64> {
        let space = &self.robot.space;
        let is_finger = |i: usize| space.upper[i] - space.lower[i] < 0.1;
        let mut number = |i: usize| if is_finger(i) { 0.0 } else { rng.random_range(-reach..=reach) };
        let mut row: Vec<f64> = (0..self.size).map(&mut number).collect();
        let boxes = self.robot.parts.iter().filter(|part| part.kind == PartKind::Object);
        for joint in boxes.filter_map(|part| part.root_joint) {
            if let foliate_components::robot::Source::Coordinates { q, .. } = self.robot.joints[joint.at()].source {
                row[q..q + 7].fill(0.0);
            }
        }
        row
    }

    /// A curve from rest in a free place, its knots and velocities drawn at random.
    fn random_curve(&self, rng: &mut ChaCha8Rng, pieces: usize, reach: f64) -> Rows {
        let mut q = self.free_start(rng);
        let mut rows = Rows::default();
        rows.push(&q, &vec![0.0; self.size], 0.0);
        for piece in 0..pieces {
            let step = self.drawn(rng, reach);
            q.iter_mut().zip(step).for_each(|(x, step)| *x += step);
            for factor in self.robot.space.factors.iter().filter(|f| f.group == Group::FreeFlyer) {
                let own = &mut q[factor.q + 3..factor.q + 7];
                let length = own.iter().map(|x| x * x).sum::<f64>().sqrt();
                own.iter_mut().for_each(|x| *x /= length);
            }
            let speed = if piece + 1 == pieces { 0.0 } else { reach };
            let velocity = self.drawn(rng, speed);
            rows.push(&q, &velocity, rng.random_range(0.3..1.5));
        }
        rows
    }

    fn certify(&self, curve: &HermiteCurve<'_>, settings: &CertificateSettings) -> CurveVerdict {
        let Self { scene, kinematics, rigid_attachments, pairs, .. } = self;
        let mut scratch = CollisionScratch::new();
        let verdict = certify_curve(scene, kinematics, rigid_attachments, curve, pairs, settings, &mut scratch);
        // Buffers that have seen another motion change nothing.
        let again = certify_curve(scene, kinematics, rigid_attachments, curve, pairs, settings, &mut scratch);
        assert_eq!(verdict, again);
        verdict
    }

    /// Clearances of moving pairs at places of the curve.
    fn sampled(&self, curve: &HermiteCurve<'_>, samples: usize) -> f64 {
        let mut q = vec![0.0; self.size];
        let mut least = f64::INFINITY;
        for sample in 0..=samples {
            let along = curve.pieces() as f64 * sample as f64 / samples as f64;
            let piece = (along as usize).min(curve.pieces() - 1);
            curve.at(&self.robot.space, piece, along - piece as f64, &mut q);
            let pairs = self.pairs.moving_pairs(&self.scene);
            least = least.min(min_clearance(&self.scene, &self.poses(&q), pairs).unwrap().clearance);
        }
        least
    }
}

#[test]
fn what_is_certified_is_free_and_what_is_clearly_free_is_certified() {
    let settings = CertificateSettings::default();
    for (name, world) in [("arms", World::arms()), ("mover", World::mover())] {
        let mut rng = ChaCha8Rng::seed_from_u64(61);
        let (mut free, mut blocked, mut shares) = (0, 0, Vec::new());
        for round in 0..80 {
            let pieces = [1, 2, 3, 9][round % 4];
            let rows = world.random_curve(&mut rng, pieces, [0.01, 0.08, 0.3][round % 3]);
            let curve = rows.curve();
            assert!(curve.is_sound(&world.robot.space));
            let least = world.sampled(&curve, 400);
            match world.certify(&curve, &settings) {
                CurveVerdict::Free { min_clearance_lower_bound: bound } => {
                    free += 1;
                    assert!(bound <= least + 2e-6, "{name} {round}: clearance {least} below the proved {bound}");
                    shares.push(bound / least);
                }
                CurveVerdict::Blocked { piece, u, blocked_by } => {
                    blocked += 1;
                    assert!(piece < pieces && (0.0..=1.0).contains(&u) && blocked_by.is_some());
                    assert!(least < 2e-3, "{name} {round}: {least} m of clearance are not certified");
                }
            }
        }
        shares.sort_by(f64::total_cmp);
        println!("{name}: {free} free, {blocked} blocked; bound / clearance median {}", shares[shares.len() / 2]);
        assert!(free >= 20 && blocked >= 10, "{name}: the test sees both kinds: {free} free, {blocked} blocked");
    }
}

#[test]
fn the_least_clearance_along_a_curve_is_found() {
    for (name, world) in [("arms", World::arms()), ("mover", World::mover())] {
        let mut rng = ChaCha8Rng::seed_from_u64(62);
        let World { scene, kinematics, rigid_attachments, pairs, .. } = &world;
        let (settings, mut scratch) = (MinimumSettings::default(), CollisionScratch::new());
        let mut free = 0;
        for round in 0..40 {
            let rows = world.random_curve(&mut rng, [1, 2, 5][round % 3], [0.01, 0.03, 0.1][round % 3]);
            let curve = rows.curve();
            let found = minimum_clearance_on_curve(
                scene,
                kinematics,
                rigid_attachments,
                &curve,
                pairs,
                &settings,
                &mut scratch,
            );
            let least = world.sampled(&curve, 400);
            assert!(found.lower <= least + 2e-6, "{name} {round}: {found:?}, sampled {least}");
            if found.lower > 0.0 {
                free += 1;
                let nearest = found.nearest.unwrap();
                let allowed = settings.absolute.max(settings.relative * nearest.clearance);
                assert!(nearest.clearance - found.lower <= allowed + 1e-12, "{name} {round}: {found:?}");
                // Pairs that do not move count too.
                assert!(nearest.clearance <= least + allowed + 1e-5, "{name} {round}: {found:?}, sampled {least}");
                let mut q = vec![0.0; world.size];
                let piece = (nearest.t as usize).min(curve.pieces() - 1);
                curve.at(&world.robot.space, piece, nearest.t - piece as f64, &mut q);
                let there = min_clearance(scene, &world.poses(&q), [nearest.pair].into_iter()).unwrap().clearance;
                assert!(there <= nearest.clearance + 2e-6, "{name} {round}: {there} at {nearest:?}");
            }
        }
        assert!(free >= 10, "{name}: {free}");
    }
}

/// A block that slides past a wall: its free-flyer's x, y, z are the first three numbers.
fn block_past_a_wall() -> World {
    let block = single(vec![(Pose::IDENTITY, cuboid(0.1, 0.1, 0.1))]);
    let wall = single(vec![(Pose::IDENTITY, cuboid(0.2, 0.1, 0.2))]);
    let robot = compose(&[
        (&block, placed("block", PartKind::Robot, RootJoint::FreeFlyer, Pose::IDENTITY)),
        (&wall, placed("wall", PartKind::Environment, RootJoint::Fixed, at(0.0, 0.3, 0.0))),
    ]);
    World::new(robot, Vec::new())
}

#[test]
fn a_curve_that_bulges_into_an_obstacle_is_refused() {
    let world = block_past_a_wall();
    let settings = CertificateSettings::default();
    // The faces are 0.2 m apart at y = 0. From (−0.5, 0) to (0.5, 0) in a second, out with speed v in y and back: 0.25 v at the top.
    for (speed, is_free) in [(0.0, true), (0.75, true), (0.7999, true), (0.8001, false), (0.9, false), (1.6, false)] {
        let mut rows = Rows::default();
        rows.push(&[-0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &[1.0, speed, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0);
        rows.push(&[0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &[1.0, -speed, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0);
        let knots = &rows.knots;
        let World { scene, kinematics, rigid_attachments, pairs, .. } = &world;
        let chord = certify_polyline(
            scene,
            kinematics,
            rigid_attachments,
            knots,
            pairs,
            &settings,
            &mut CollisionScratch::new(),
        );
        assert!(matches!(chord, PolylineVerdict::Free { .. }), "the chord is free");
        let verdict = world.certify(&rows.curve(), &settings);
        assert_eq!(matches!(verdict, CurveVerdict::Free { .. }), is_free, "{speed}: {verdict:?}");
        if let CurveVerdict::Blocked { u, blocked_by, .. } = verdict {
            assert!(blocked_by.is_some() && u > 0.1 && u < 0.9, "{verdict:?}");
        }
    }
}

#[test]
fn a_block_that_turns_into_an_obstacle_is_refused() {
    let world = block_past_a_wall();
    let settings = CertificateSettings::default();
    // 1 cm beside the wall turned by 45 degrees a corner of the block is √½ · 0.1 m from its middle, 2.07 cm farther out than a face.
    let row = |y: f64, angle: f64| [0.0, y, 0.0, 0.0, 0.0, (0.5 * angle).sin(), (0.5 * angle).cos()];
    for (y, is_free) in [(0.19, false), (0.1794, false), (0.1792, true), (0.175, true)] {
        let mut rows = Rows::default();
        let quarter = std::f64::consts::FRAC_PI_2;
        // A turn of a quarter with the speed of a slerp at both ends.
        let speed = |angle: f64| {
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.5 * quarter * (0.5 * angle).cos(), -0.5 * quarter * (0.5 * angle).sin()]
        };
        rows.push(&row(y, 0.0), &speed(0.0), 0.0);
        rows.push(&row(y, quarter), &speed(quarter), 1.0);
        let verdict = world.certify(&rows.curve(), &settings);
        let limit = 0.25 - 0.1 * std::f64::consts::FRAC_1_SQRT_2;
        assert_eq!(y < limit, is_free, "the test's own sum");
        assert_eq!(matches!(verdict, CurveVerdict::Free { .. }), is_free, "{y}: {verdict:?}");
    }
}

#[test]
fn close_contact_is_left_and_approached_along_curves() {
    // A block leaves a wall from 1.2e-5 m of clearance, and comes back: the guard is 1e-5.
    let world = block_past_a_wall();
    let mut rows = Rows::default();
    let still = [0.0; 7];
    let row = |x: f64, y: f64| [x, y, 0.0, 0.0, 0.0, 0.0, 1.0];
    let near = 0.2 - 1.2e-5;
    rows.push(&row(0.0, near), &still, 0.0);
    rows.push(&row(0.0, 0.05), &still, 1.0);
    rows.push(&row(0.05, 0.05), &still, 1.0);
    rows.push(&row(0.05, near), &still, 1.0);
    let verdict = world.certify(&rows.curve(), &CertificateSettings::default());
    assert!(matches!(verdict, CurveVerdict::Free { .. }), "{verdict:?}");
    // Slid along the wall it bends towards it by 3e-6 m at the most: 4/27 of the speed, with one end at rest.
    for (speed, is_free) in [(1.2e-5, true), (1.6e-5, false)] {
        let mut rows = Rows::default();
        rows.push(&row(0.0, near), &[0.2, speed, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0);
        rows.push(&row(0.2, near), &[0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0);
        let verdict = world.certify(&rows.curve(), &CertificateSettings::default());
        assert_eq!(matches!(verdict, CurveVerdict::Free { .. }), is_free, "{speed}: {verdict:?}");
    }
}

#[test]
fn hostile_curves_are_refused() {
    let world = World::mover();
    let mut rng = ChaCha8Rng::seed_from_u64(63);
    let rows = world.random_curve(&mut rng, 4, 0.01);
    let settings = CertificateSettings::default();
    let refused = |rows: &Rows| {
        let verdict = world.certify(&rows.curve(), &settings);
        matches!(verdict, CurveVerdict::Blocked { .. })
    };
    assert!(!refused(&rows), "the curve itself is fine");
    for bad in [f64::NAN, f64::INFINITY, 1e308, -1e200] {
        for what in 0..2 {
            let mut rows = rows.clone();
            let numbers = if what == 0 { &mut rows.knots } else { &mut rows.velocities };
            numbers[2 * world.size + 1] = bad;
            assert!(refused(&rows), "{bad} in {what}");
        }
    }
    let mut late = rows.clone();
    late.times[2] = 100.0;
    assert!(refused(&late), "times that decrease");
    let mut jump = rows.clone();
    jump.times[2] = jump.times[1];
    assert!(refused(&jump), "a jump");
    let mut short = rows.clone();
    short.velocities.truncate(world.size);
    assert!(refused(&short), "rows that do not fit");
    let mut flip = rows.clone();
    let flyer = world.robot.space.factors.iter().find(|f| f.group == Group::FreeFlyer).unwrap().q;
    flip.knots[2 * world.size + flyer + 3..][..4].iter_mut().for_each(|x| *x = -*x);
    assert!(refused(&flip), "a quaternion that goes through zero");
    let few = CertificateSettings { max_samples: 3, ..settings };
    assert!(matches!(world.certify(&rows.curve(), &few), CurveVerdict::Blocked { .. }), "three samples");
    // A stand is free where its place is.
    let mut stand = Rows::default();
    stand.push(&rows.knots[..world.size], &rows.velocities[..world.size], 0.0);
    stand.push(&rows.knots[..world.size], &rows.velocities[..world.size], 0.0);
    assert!(!refused(&stand), "a stand without duration");
}

#[test]
fn limits_are_those_of_dense_samples() {
    let world = World::arms();
    let mut rng = ChaCha8Rng::seed_from_u64(64);
    let (mut within, mut beyond) = (0, 0);
    let mut q = vec![0.0; world.size];
    for _ in 0..200 {
        let rows = world.random_curve(&mut rng, 3, 0.15);
        let (curve, space) = (rows.curve(), &world.robot.space);
        let found = curve.first_out_of_bounds(space, 1e-9, |_| true);
        let mut sampled = None;
        for step in 0..=600 {
            let piece = (step / 200).min(2);
            curve.at(space, piece, (step - 200 * piece) as f64 / 200.0, &mut q);
            sampled = sampled.or(space.first_out_of_bounds(&q, 1e-9));
        }
        match found {
            None => {
                within += 1;
                assert_eq!(sampled, None);
            }
            Some(limit) => {
                beyond += 1;
                let i = limit.coordinate;
                assert!(limit.value < space.lower[i] || limit.value > space.upper[i], "{limit:?}");
            }
        }
    }
    assert!(within > 20 && beyond > 20, "{within} {beyond}");
}

/// A polyline's corners cut by symmetric quadratic arcs, which are exact cubics; unit speed in the first norm of configurations.
fn blended(world: &World, corners: &[Vec<f64>], radius: f64) -> Rows {
    let length = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt();
    let direction = |a: &[f64], b: &[f64]| -> Vec<f64> {
        let length = length(a, b);
        a.iter().zip(b).map(|(x, y)| (y - x) / length).collect()
    };
    let shifted = |q: &[f64], v: &[f64], by: f64| -> Vec<f64> { q.iter().zip(v).map(|(x, v)| x + by * v).collect() };
    let mut rows = Rows::default();
    let mut velocity = direction(&corners[0], &corners[1]);
    rows.push(&corners[0], &velocity, 0.0);
    let mut last = corners[0].clone();
    for three in corners.windows(3) {
        let next = direction(&three[1], &three[2]);
        let r = radius.min(0.4 * length(&three[0], &three[1])).min(0.4 * length(&three[1], &three[2]));
        let (begin, end) = (shifted(&three[1], &velocity, -r), shifted(&three[1], &next, r));
        rows.push(&begin, &velocity, length(&last, &begin));
        rows.push(&end, &next, 2.0 * r);
        (velocity, last) = (next, end);
    }
    let goal = corners.last().unwrap();
    rows.push(goal, &velocity, length(&last, goal));
    assert_eq!(rows.times.len(), 2 * corners.len() - 2);
    assert!(rows.curve().is_sound(&world.robot.space));
    rows
}

/// Prints what blended paths cost beside their polylines; run with `--release --nocapture` to read it.
#[test]
fn costs() {
    let world = World::arms();
    let mut rng = ChaCha8Rng::seed_from_u64(65);
    let settings = CertificateSettings { start_is_free: true, all_or_nothing: true, ..CertificateSettings::default() };
    let World { scene, kinematics, rigid_attachments, pairs, .. } = &world;
    let mut scratch = CollisionScratch::new();
    for (name, corners, reach) in [("3 corners, 1 rad", 5, 0.4), ("8 corners, 0.4 rad", 10, 0.15)] {
        let (mut straight, mut curved, mut free, mut tried) = (0.0, 0.0, 0, 0);
        while free < 60 && tried < 5000 {
            tried += 1;
            let mut q = world.free_start(&mut rng);
            let mut path = vec![q.clone()];
            for _ in 1..corners {
                let step = world.drawn(&mut rng, reach);
                q.iter_mut().zip(step).for_each(|(x, step)| *x += step);
                path.push(q.clone());
            }
            let rows = blended(&world, &path, 0.1);
            let polyline = path.concat();
            let mut fastest = [f64::INFINITY; 2];
            let mut is_free = [false; 2];
            for _ in 0..3 {
                let begin = Instant::now();
                let verdict =
                    certify_polyline(scene, kinematics, rigid_attachments, &polyline, pairs, &settings, &mut scratch);
                is_free[0] = matches!(verdict, PolylineVerdict::Free { .. });
                fastest[0] = fastest[0].min(begin.elapsed().as_secs_f64());
                let begin = Instant::now();
                let verdict =
                    certify_curve(scene, kinematics, rigid_attachments, &rows.curve(), pairs, &settings, &mut scratch);
                is_free[1] = matches!(verdict, CurveVerdict::Free { .. });
                fastest[1] = fastest[1].min(begin.elapsed().as_secs_f64());
            }
            if is_free == [true; 2] {
                free += 1;
                straight += fastest[0];
                curved += fastest[1];
            }
        }
        let each = 1e6 / f64::from(free);
        println!("{name}: {free} free; polyline {:.0} µs, blended {:.0} µs", straight * each, curved * each);
        assert!(free > 5, "{free} free of {tried}");
    }
}
