//! Once their buffers are warm the kernels ask nothing of the allocator: whatever a search does a million times, it does in
//! memory that it has.
//!
//! The counter stands before the global allocator and counts by thread, so tests side by side do not count each other's.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

mod collision_models;
mod heavy_world;

use allocation_counter::measure;
use collision_models::{always_colliding, at, box_mesh, placed, random_configuration, single, star, two_arms};
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Grasp, Reference, RelativePose, Row};
use foliate_components::pose::exp_so3;
use foliate_components::robot::shape::Geometry;
use foliate_components::robot::{PartKind, Robot, RootJoint};
use foliate_components::samples::models;
use foliate_kernels::collision::{
    CertificateSettings, CollisionScene, CollisionScratch, CurveVerdict, MotionVerdict, PairRule, PairSet,
    PolylineVerdict, TestOrder, Verdicts, certify_curve, certify_motion, certify_polyline, first_collision,
};
use foliate_kernels::constrained_motion::{
    ConstraintProgram, CurveScratch, Job, MotionScratch, MotionSettings, OffLeaf, Scratch, Settings, curve_residual,
    project, project_batch, project_motion,
};
use foliate_kernels::constraints::{placement_of, relative_pose};
use foliate_kernels::curve::HermiteCurve;
use foliate_kernels::kinematics::{AttachmentTree, Kinematics, RigidAttachment, geometric_jacobian};
use foliate_kernels::lanes::Level;
use foliate_kernels::nearest::{Bucket, BucketQueries, Metric, nearest};
use foliate_kernels::trajectory::{
    JerkScratch, Limits, Spline, ThroughScratch, TimedPath, TimingScratch, TimingSettings, blend_polyline, limit_jerk,
    peak_rates, spline_through, time_optimal,
};
use glam::DVec3;
use heavy_world::{Draw, held, world};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::hint::black_box;
use std::sync::Arc;

/// How often `work` asks for memory when it is done once more. It is done twice before: what takes turns with another buffer
/// has then been as large as it gets in either place.
fn allocations(mut work: impl FnMut()) -> u64 {
    work();
    work();
    measure(work).count_total
}

#[test]
fn the_counter_counts() {
    let mut kept = Vec::new();
    let once = allocations(|| kept.push(black_box(Box::new(1))));
    assert!(once >= 1, "a box is an allocation: {once}");
    let mut buffer = Vec::new();
    let again = allocations(|| {
        buffer.clear();
        buffer.extend_from_slice(&[1.0; 64]);
    });
    assert_eq!(again, 0, "a buffer that is large enough is none");
}

#[test]
fn kinematics() {
    let robot = world();
    let (kinematics, rigid_attachments) = (Kinematics::new(&robot), held(&robot));
    let mut draw = Draw::new(1);
    let samples: Vec<_> = (0..20).map(|_| draw.configuration(&robot)).collect();
    let tip = robot.joint("arm/w2");
    let columns = AttachmentTree::new(&robot).columns(None, tip, |v| (v < 7).then_some(v));
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    let (mut jacobian, mut written) = ([0.0; 42], robot.space.neutral());
    let count = allocations(|| {
        for q in &samples {
            kinematics.forward(q, &mut X_WJ);
            kinematics.carry(q, &rigid_attachments, &mut X_WJ);
            written.copy_from_slice(q);
            kinematics.write_back(&rigid_attachments, &X_WJ, &mut written);
            let point = X_WJ[tip.unwrap().at()].translation;
            geometric_jacobian(&columns, &X_WJ, point, &mut jacobian);
            black_box(&jacobian);
        }
    });
    assert_eq!(count, 0);
}

/// Two seven-axis arms and a block.
fn workcell() -> Robot {
    let (arm, block) = (models::seven_axis_arm(), models::block(DVec3::new(0.06, 0.06, 0.12)));
    Robot::compose(&[
        (&arm, models::fixed_robot("left", at(0.0, 0.3, 0.0))),
        (&arm, models::fixed_robot("right", at(0.0, -0.3, 0.0))),
        (&block, models::movable_object("block")),
    ])
    .unwrap()
}

/// Rows that hold the block with both hands, from opposite sides.
fn both_hands(robot: &Robot) -> [Constraint; 2] {
    let top = robot.handle("block/top").unwrap();
    let [left, right] =
        ["left/hand", "right/hand"].map(|g| Grasp::new(robot, robot.gripper(g).unwrap(), top).unwrap().constraint());
    let opposite = Pose::from_rotation(exp_so3(DVec3::Y * std::f64::consts::PI));
    let right = RelativePose { b: right.b.then(&opposite), ..right };
    [Constraint::RelativePose(left), Constraint::RelativePose(right)]
}

/// Problems in a queue: more than there are lanes, so that lanes are filled again.
const QUEUE: usize = 20;

#[test]
fn newton_in_queues_of_lanes() {
    let robot = workcell();
    let kinematics = Kinematics::new(&robot);
    let hand = Grasp::new(&robot, robot.gripper("left/hand").unwrap(), robot.handle("block/top").unwrap()).unwrap();
    let reach = RelativePose::rigid(Frame::world(Pose::identity()), hand.gripper, Reference::Argument(0));
    let tip = placement_of(&hand.gripper);
    let compile = |c: &[Constraint]| ConstraintProgram::compile(&robot, &kinematics, c, &[], &[]).unwrap();
    let programs = [compile(&[Constraint::RelativePose(reach)]), compile(&both_hands(&robot))];
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let starts: Vec<_> = (0..16 * QUEUE).map(|_| random_configuration(&robot, &mut rng)).collect();
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    let targets: Vec<Pose> = (0..16 * QUEUE)
        .map(|_| {
            kinematics.forward(&random_configuration(&robot, &mut rng), &mut X_WJ);
            tip.in_world(&X_WJ)
        })
        .collect();
    let mut queue: Vec<Vec<f64>> = starts[..QUEUE].to_vec();
    let mut scratch = Scratch::default();
    let double = Settings::default();
    let single = Settings { single_until: 1e-4, ..double };
    let (mut solved, mut failed) = (0, 0);
    let count = allocations(|| {
        for (program, settings) in programs.iter().flat_map(|program| [(program, double), (program, single)]) {
            for (starts, targets) in starts.chunks(QUEUE).zip(targets.chunks(QUEUE)) {
                queue.iter_mut().zip(starts).for_each(|(q, start)| q.copy_from_slice(start));
                let mut problems = queue.iter_mut().zip(targets);
                let mut jobs: [Job<'_>; QUEUE] = std::array::from_fn(|_| {
                    let (q, target) = problems.next().unwrap();
                    Job::new(q, std::slice::from_ref(target))
                });
                project_batch(program, &mut jobs, &settings, &mut scratch);
                let converged = jobs.iter().filter(|job| job.outcome.is_converged()).count();
                (solved, failed) = (solved + converged, failed + QUEUE - converged);
            }
        }
    });
    assert!(solved > 100 && failed > 100, "{solved} solved, {failed} not: both ways out are to be taken");
    assert_eq!(count, 0);
}

/// Motions on a program's leaf between configurations near each other, and how many knots they have.
fn motions_on(robot: &Robot, program: &ConstraintProgram, arguments: &[Pose], draw: &mut Draw) -> (u64, usize) {
    let (settings, mut scratch) = (Settings::default(), Scratch::default());
    let mut solve = |q: &mut Vec<f64>| project(program, q, arguments, &settings, &mut scratch).is_converged();
    let mut ends = Vec::new();
    for _ in 0..200 {
        let mut from = draw.configuration(robot);
        if !solve(&mut from) {
            continue;
        }
        let mut v = vec![0.0; robot.space.dimension()];
        v.iter_mut().for_each(|x| *x = draw.rng.random_range(-0.2..0.2));
        let mut to = from.clone();
        robot.space.integrate(&from, &v, &mut to);
        if solve(&mut to) {
            ends.push((from, to));
        }
        if ends.len() == 10 {
            break;
        }
    }
    let (mut scratch, mut knots, mut most) = (MotionScratch::default(), Vec::new(), 0);
    let settings = MotionSettings { path_tolerance: 1e-3, ..MotionSettings::default() };
    let count = allocations(|| {
        for (from, to) in &ends {
            knots.clear();
            let _end =
                project_motion(program, &robot.space, (from, to), arguments, &settings, &mut scratch, &mut knots);
            most = most.max(knots.len() / robot.space.size());
        }
    });
    (count, most)
}

#[test]
fn motions_with_both_hands_on_one_object() {
    let robot = workcell();
    let kinematics = Kinematics::new(&robot);
    let program = ConstraintProgram::compile(&robot, &kinematics, &both_hands(&robot), &[], &[]).unwrap();
    let (count, knots) = motions_on(&robot, &program, &[], &mut Draw::new(3));
    assert!(knots > 4, "the longest motion has {knots} knots");
    assert_eq!(count, 0);
}

#[test]
fn motions_in_balance_at_a_distance_and_with_a_function_of_the_hosts() {
    let robot = world();
    let kinematics = Kinematics::new(&robot);
    let mut draw = Draw::new(4);
    let mut most = [0; 4];
    for _ in 0..4 {
        let between = draw.between(&robot, None);
        let constraints = [
            Constraint::CentreOfMass(draw.balance(&robot, [Row::Zero, Row::Zero, Row::Inequality])),
            Constraint::CentreOfMassBetween(between),
            Constraint::Distance(draw.distance(&robot, Row::Inequality, false)),
            Constraint::Custom(draw.gaze(&robot)),
        ];
        for (constraint, most) in constraints.into_iter().zip(&mut most) {
            let one = std::slice::from_ref(&constraint);
            let Ok(program) = ConstraintProgram::compile(&robot, &kinematics, one, &[], &[]) else { continue };
            let (count, knots) = motions_on(&robot, &program, &[Pose::identity()], &mut draw);
            assert_eq!(count, 0, "{constraint:?}");
            *most = (*most).max(knots);
        }
    }
    assert!(most.iter().all(|&knots| knots > 2), "the longest motions have {most:?} knots");
}

/// Two arms, the left one with a box in its hand, before a table with a mesh on it and another mesh beside it.
struct Workplace {
    robot: Robot,
    scene: CollisionScene,
    kinematics: Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
    pairs: PairSet,
    rng: ChaCha8Rng,
}

impl Workplace {
    fn new() -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mesh = |mesh| single(vec![(Pose::IDENTITY, Geometry::Mesh(Arc::new(mesh)))]);
        let (arms, table) = (two_arms(), mesh(box_mesh(DVec3::new(0.4, 0.7, 0.025), 4)));
        let (stone, held) = (mesh(star(&mut rng, 0.15)), mesh(box_mesh(DVec3::new(0.025, 0.025, 0.06), 2)));
        let robot = collision_models::compose(&[
            (&arms, placed("robot", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY)),
            (&table, placed("table", PartKind::Environment, RootJoint::Fixed, at(0.8, 0.0, -0.2))),
            (&stone, placed("stone", PartKind::Environment, RootJoint::Fixed, at(0.7, 0.1, 0.05))),
            (&held, placed("box", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
        ]);
        let root = robot.joint("box/root_joint").unwrap();
        let carrier = robot.joint("robot/left_j6");
        let rigid_attachments = vec![RigidAttachment { object: root, carrier, X_CO: at(0.31, 0.0, 0.0) }];
        let ignored = always_colliding(&robot);
        let scene = CollisionScene::new(&robot, &PairRule { ignored: &ignored, ..PairRule::default() });
        let pairs = PairSet::new(&scene, &rigid_attachments, &[]);
        Self { kinematics: Kinematics::new(&robot), robot, scene, rigid_attachments, pairs, rng }
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        heavy_world::poses(&self.kinematics, &self.rigid_attachments, q)
    }

    /// Free configurations and such that are not.
    fn samples(&mut self, count: usize) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let all: Vec<_> = (0..count).map(|_| random_configuration(&self.robot, &mut self.rng)).collect();
        let mut scratch = CollisionScratch::new();
        all.into_iter()
            .partition(|q| first_collision(&self.scene, &self.poses(q), &self.pairs, 0.0, &mut scratch).is_none())
    }
}

#[test]
fn exact_verdicts() {
    let mut place = Workplace::new();
    let (free, blocked) = place.samples(800);
    assert!(free.len() > 20 && blocked.len() > 20, "{} free, {} not", free.len(), blocked.len());
    let poses: Vec<_> = free.iter().chain(&blocked).map(|q| place.poses(q)).collect();
    let mut scratch = CollisionScratch::new();
    let count = allocations(|| {
        for X_WJ in &poses {
            black_box(first_collision(&place.scene, X_WJ, &place.pairs, 1e-5, &mut scratch));
        }
    });
    assert_eq!(count, 0);
}

#[test]
fn exact_verdicts_in_lanes() {
    let mut place = Workplace::new();
    let (free, blocked) = place.samples(800);
    let all: Vec<f64> = free.iter().chain(&blocked).flatten().copied().collect();
    let ends: Vec<usize> = (1..=(free.len() + blocked.len()) / 3).map(|row| 3 * row).collect();
    let all = &all[..3 * ends.len() * place.robot.space.size()];
    let Workplace { scene, kinematics, rigid_attachments, pairs, .. } = &place;
    let verdicts = Verdicts { scene, kinematics, rigid_attachments, pairs, guard: 1e-5 };
    let (mut scratch, mut found) = (CollisionScratch::new(), Vec::new());
    let count = allocations(|| {
        found.clear();
        verdicts.first_in_rows(all, &ends, &mut scratch, &mut found);
    });
    assert!(found.iter().any(Option::is_some) && found.iter().any(Option::is_none));
    assert_eq!(count, 0);
}

#[test]
fn samples_of_motions() {
    let mut place = Workplace::new();
    let (free, _) = place.samples(800);
    let Workplace { robot, scene, kinematics, rigid_attachments, pairs, .. } = &place;
    let verdicts = Verdicts { scene, kinematics, rigid_attachments, pairs, guard: 1e-5 };
    let (mut scratch, mut order) = (CollisionScratch::new(), TestOrder::default());
    let mut motion = vec![0.0; 17 * robot.space.size()];
    let (mut whole, mut cut) = (0, 0);
    let count = allocations(|| {
        for ends in free.windows(2) {
            for (number, q) in motion.chunks_exact_mut(robot.space.size()).enumerate() {
                robot.space.interpolate(&ends[0], &ends[1], number as f64 / 16.0, q);
            }
            match verdicts.first_on_motion(&motion, &mut order, &mut scratch) {
                None => whole += 1,
                Some(_) => cut += 1,
            }
        }
    });
    assert!(whole > 0 && cut > 0, "{whole} {cut}");
    assert_eq!(count, 0);
}

#[test]
fn certificates_of_straight_motions() {
    let mut place = Workplace::new();
    let (free, _) = place.samples(800);
    let (settings, mut scratch) = (CertificateSettings::default(), CollisionScratch::new());
    let (mut whole, mut cut) = (0, 0);
    let count = allocations(|| {
        for ends in free.windows(2) {
            let Workplace { scene, kinematics, rigid_attachments, pairs, .. } = &place;
            match certify_motion(
                scene,
                kinematics,
                rigid_attachments,
                &ends[0],
                &ends[1],
                pairs,
                &settings,
                &mut scratch,
            ) {
                MotionVerdict::Free { .. } => whole += 1,
                MotionVerdict::FreeUntil { .. } => cut += 1,
            }
        }
    });
    assert!(whole > 0 && cut > 0, "{whole} free, {cut} cut");
    assert_eq!(count, 0);
}

#[test]
fn certificates_of_polylines() {
    let mut place = Workplace::new();
    let (free, _) = place.samples(800);
    let space = &place.robot.space;
    // From one free configuration a part of the way towards another, in many pieces.
    let polylines: Vec<Vec<f64>> = free
        .windows(2)
        .take(60)
        .map(|ends| {
            let mut q = ends[0].clone();
            let mut knots = Vec::new();
            for piece in 0..=12 {
                space.interpolate(&ends[0], &ends[1], f64::from(piece) / 24.0, &mut q);
                knots.extend_from_slice(&q);
            }
            knots
        })
        .collect();
    let (settings, mut scratch) = (CertificateSettings::default(), CollisionScratch::new());
    let (mut whole, mut cut) = (0, 0);
    let count = allocations(|| {
        for knots in &polylines {
            let Workplace { scene, kinematics, rigid_attachments, pairs, .. } = &place;
            match certify_polyline(scene, kinematics, rigid_attachments, knots, pairs, &settings, &mut scratch) {
                PolylineVerdict::Free { .. } => whole += 1,
                PolylineVerdict::FreeUntil { .. } => cut += 1,
            }
        }
    });
    assert!(whole > 0 && cut > 0, "{whole} free, {cut} cut");
    assert_eq!(count, 0);
}

#[test]
fn certificates_of_curves() {
    let mut place = Workplace::new();
    let (free, _) = place.samples(800);
    let size = place.robot.space.size();
    // From a free configuration with some velocity to a little way towards another, and on from there.
    let curves: Vec<(Vec<f64>, Vec<f64>)> = free
        .windows(2)
        .take(60)
        .map(|ends| {
            let mut knots = Vec::new();
            let mut q = ends[0].clone();
            for knot in 0..3 {
                place.robot.space.interpolate(&ends[0], &ends[1], 0.1 * f64::from(knot), &mut q);
                knots.extend_from_slice(&q);
            }
            let velocities = (0..3 * size).map(|i| 0.01 * ((i * 7 % 5) as f64 - 2.0)).collect();
            (knots, velocities)
        })
        .collect();
    let (settings, mut scratch) = (CertificateSettings::default(), CollisionScratch::new());
    let (mut whole, mut blocked) = (0, 0);
    let count = allocations(|| {
        for (knots, velocities) in &curves {
            let Workplace { scene, kinematics, rigid_attachments, pairs, .. } = &place;
            let curve = HermiteCurve { knots, velocities, times: &[0.0, 0.7, 1.9] };
            match certify_curve(scene, kinematics, rigid_attachments, &curve, pairs, &settings, &mut scratch) {
                CurveVerdict::Free { .. } => whole += 1,
                CurveVerdict::Blocked { .. } => blocked += 1,
            }
        }
    });
    assert!(whole > 0 && blocked > 0, "{whole} free, {blocked} blocked");
    assert_eq!(count, 0);
}

#[test]
fn residuals_of_curves() {
    let robot = world();
    let kinematics = Kinematics::new(&robot);
    let mut draw = Draw::new(5);
    let (from, bodies) = (draw.configuration(&robot), |q: &[f64]| {
        let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
        kinematics.forward(q, &mut X_WJ);
        X_WJ
    });
    let (a, b) = (Frame::world(Pose::identity()), Frame::of_joint(robot.joint("arm/w2").unwrap()));
    let reference = Reference::Fixed(relative_pose::pose(&placement_of(&a), &placement_of(&b), &bodies(&from)));
    let rows = [Some(Row::Zero); 6];
    let pose = Constraint::RelativePose(RelativePose { a, b, rows, reference });
    let program = ConstraintProgram::compile(&robot, &kinematics, &[pose], &[], &[]).unwrap();
    let knots = [from.clone(), from].concat();
    let velocities: Vec<f64> = (0..knots.len()).map(|i| 1e-2 * ((i % 5) as f64 - 2.0)).collect();
    let curve = HermiteCurve { knots: &knots, velocities: &velocities, times: &[0.0, 1.0] };
    let mut scratch = CurveScratch::default();
    let mut proved = Err(OffLeaf { piece: 0, u: 0.0 });
    let count = allocations(|| proved = curve_residual(&program, &robot.space, &curve, &[], 0.05, &mut scratch));
    assert!(proved.is_ok_and(|most| most > 1e-4), "{proved:?}");
    assert_eq!(count, 0);
}

#[test]
fn nearest_configurations() {
    let robot = world();
    let (space, mut draw) = (&robot.space, Draw::new(6));
    let weights = vec![1.0; space.dimension()];
    let metric = Metric::new(space, &weights);
    let all: Vec<_> = (0..600).map(|_| draw.configuration(&robot)).collect();
    let mut bucket = Bucket::default();
    (0..).zip(&all).for_each(|(id, q)| bucket.push(&metric, id, q));
    let (mut queries, mut best) = (BucketQueries::default(), Vec::new());
    let asked = allocations(|| {
        for together in [23, 1, 5] {
            let those = &all[..together];
            queries.set(&metric, those.iter().map(Vec::as_slice));
            let exact = |query: usize, id: u32| space.distance(&those[query], &all[id as usize], &weights);
            nearest((&metric, &queries, Level::detected()), [&bucket].into_iter(), exact, &mut best);
            assert!(best.iter().all(Option::is_some));
        }
    });
    assert_eq!(asked, 0);
}

#[test]
fn trajectories() {
    let mut random = ChaCha8Rng::seed_from_u64(8);
    let limits = [2.0; 6];
    let knots: Vec<Vec<f64>> =
        [9, 14, 5].map(|count| (0..count * 6).map(|_| random.random_range(-2.0..2.0)).collect()).to_vec();
    let (mut path, mut through, mut scratch, mut timed) =
        (Spline::new(6), ThroughScratch::default(), TimingScratch::default(), TimedPath::default());
    let jerk = [40.0; 6];
    let limits = Limits { velocity: &limits, acceleration: &limits, jerk: &jerk };
    let (mut smooth, mut averaged) = (JerkScratch::default(), Spline::new(6));
    let asked = allocations(|| {
        for knots in &knots {
            spline_through(knots, limits.velocity, &mut through, &mut path).unwrap();
            time_optimal(&path, limits, TimingSettings::default(), &mut scratch, &mut timed).unwrap();
            black_box(peak_rates(&timed.curve, limits));
            limit_jerk(&timed.curve, limits, &mut smooth, &mut averaged).unwrap();
            blend_polyline(knots, &[0.01; 14][..knots.len() / 6], limits.velocity, &mut path).unwrap();
            time_optimal(&path, limits, TimingSettings::default(), &mut scratch, &mut timed).unwrap();
        }
    });
    assert_eq!(asked, 0);
}
