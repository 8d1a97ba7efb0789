//! What does it cost to put a seven-joint arm's hand where a top-down grasp wants it, per try and per success; and a
//! humanoid on both feet, in balance, with a hand in place?
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot be set up has nothing to measure")]

use criterion::{BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement};
use foliate::scene::{PackagePath, read_model};
use foliate_benches::{criterion, random_configurations, sample_model, skipped};
use foliate_components::Pose;
use foliate_components::constraint::{CentreOfMass, Constraint, Masses, PlaneRow, Row};
use foliate_components::constraint::{Frame, Grasp, Reference, RelativePose};
use foliate_components::pose::pose_to_array;
use foliate_components::robot::model::Model as RobotModel;
use foliate_components::robot::{PartIndex, PartKind, PartPlacement, Robot, RootJoint, Source};
use foliate_components::sample_models;
use foliate_kernels::constraints::{centre_of_mass, placement_of};
use foliate_kernels::kinematics::Kinematics;
use foliate_kernels::projection::{
    ArgumentBlock, ConstraintProgram, LANES, LaneBlock, LaneMask, Outcome, Scratch, Settings, project, project_batch,
};
use foliate_systems::model::PlanningModel;
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::time::Instant;

/// Targets; a multiple of the lanes.
const TRIES: usize = 4096;

/// Where a hand that holds a box from above is: over the table, x down, any turn about the vertical. A low-discrepancy
/// sequence, so that the targets are spread evenly and the same in every run. Not all can be reached.
fn top_down_targets() -> Vec<Pose> {
    let target = |i: usize| {
        let share = |step: f64| (0.5 + i as f64 * step).fract();
        let at =
            DVec3::new(0.35 + 0.6 * share(0.754_877), -0.6 + 1.2 * share(0.569_840), 0.03 + 0.1 * share(0.819_172));
        Pose::from_parts(at, DQuat::from_rotation_z(TAU * share(0.671_043)) * DQuat::from_rotation_y(FRAC_PI_2))
    };
    (0..TRIES).map(target).collect()
}

/// The hand at a pose that is an argument: six rows, seven columns.
fn reach(model: &PlanningModel) -> ConstraintProgram {
    let robot = &model.problem.robot;
    let grasp = Grasp::new(robot, robot.gripper("arm/hand").unwrap(), robot.handle("box0/top").unwrap()).unwrap();
    let rows = RelativePose::rigid(Frame::world(Pose::identity()), grasp.gripper, Reference::Argument(0));
    let program =
        ConstraintProgram::compile(robot, &model.kinematics, &[Constraint::RelativePose(rows)], &[], &[]).unwrap();
    assert_eq!((program.active().len(), program.rows()), (7, 6));
    program
}

/// Blocks of starts.
fn blocks_of(starts: &[Vec<f64>]) -> Vec<LaneBlock> {
    let block = |lanes: &[Vec<f64>]| {
        let mut block = LaneBlock::new(lanes[0].len());
        lanes.iter().enumerate().for_each(|(lane, q)| block.set(lane, q));
        block
    };
    starts.chunks(LANES).map(block).collect()
}

fn arguments_of(targets: &[Pose]) -> Vec<ArgumentBlock> {
    let block = |lanes: &[Pose]| {
        let mut block = ArgumentBlock::new(1);
        lanes.iter().enumerate().for_each(|(lane, pose)| block.set(0, lane, pose));
        block
    };
    targets.chunks(LANES).map(block).collect()
}

/// Of many configurations the one whose hand is nearest to each target: what a table of reachable seeds would give.
fn seeded(model: &PlanningModel, targets: &[Pose]) -> Vec<Vec<f64>> {
    let robot = &model.problem.robot;
    let hand = robot.gripper("arm/hand").unwrap();
    let frame = placement_of(&Frame::on_link(
        robot,
        robot.grippers[hand.at()].link,
        &robot.grippers[hand.at()].link_from_gripper,
    ));
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    let table: Vec<(Vec<f64>, Pose)> = random_configurations(robot, 20_000)
        .into_iter()
        .map(|q| {
            model.kinematics.forward(&q, &mut X_WJ);
            (q, frame.in_world(&X_WJ))
        })
        .collect();
    let gap = |a: &Pose, b: &Pose| {
        let turn = 1.0 - a.rotation.dot(b.rotation).abs();
        a.translation.distance(b.translation) + turn
    };
    let nearest = |target: &Pose| table.iter().min_by(|a, b| gap(&a.1, target).total_cmp(&gap(&b.1, target))).unwrap();
    targets.iter().map(|target| nearest(target).0.clone()).collect()
}

/// One pass over all blocks: how many tries succeed, and in how many iterations.
fn pass(
    program: &ConstraintProgram,
    blocks: &mut [LaneBlock],
    arguments: &[ArgumentBlock],
    scratch: &mut Scratch,
) -> (u32, u32) {
    let (mut solved, mut iterations) = (0, 0);
    let mut outcomes = [Outcome::Idle; LANES];
    for (block, arguments) in blocks.iter_mut().zip(arguments) {
        project_batch(program, block, arguments, LaneMask::ALL, &Settings::default(), &mut outcomes, scratch);
        for outcome in &outcomes {
            match outcome {
                Outcome::Converged { iterations: n, .. } => (solved, iterations) = (solved + 1, iterations + n),
                Outcome::Stagnated { iterations: n, .. } => iterations += n,
                _ => iterations += Settings::default().iterations,
            }
        }
    }
    (solved, iterations)
}

fn bench_starts(
    group: &mut BenchmarkGroup<'_, measurement::WallTime>,
    name: &str,
    program: &ConstraintProgram,
    starts: &[Vec<f64>],
    targets: &[Pose],
) {
    let (blocks, arguments) = (blocks_of(starts), arguments_of(targets));
    let mut scratch = Scratch::default();
    let mut best = f64::INFINITY;
    let (mut solved, mut iterations) = (0, 0);
    for _ in 0..5 {
        let mut fresh = blocks.clone();
        let started = Instant::now();
        (solved, iterations) = pass(program, &mut fresh, &arguments, &mut scratch);
        best = best.min(started.elapsed().as_secs_f64());
    }
    println!(
        "{name}: of {} tries {:.1} % succeed, {:.1} Newton steps and {:.2} us per try, {:.2} us per success",
        starts.len(),
        100.0 * f64::from(solved) / starts.len() as f64,
        f64::from(iterations) / starts.len() as f64,
        best * 1e6 / starts.len() as f64,
        best * 1e6 / f64::from(solved.max(1)),
    );
    group.bench_function(name, |b| {
        b.iter_batched_ref(
            || blocks.clone(),
            |blocks| pass(program, blocks, &arguments, &mut scratch),
            BatchSize::LargeInput,
        );
    });
}

/// A humanoid that stands: the sample in code, or a published one.
struct Humanoid {
    name: &'static str,
    robot: Robot,
    standing: Vec<f64>,
    ankles: [Frame; 2],
    hand: Frame,
}

impl Humanoid {
    fn new(name: &'static str, model: &RobotModel, ankles: [&str; 2], hand: &str, bent: &[(&str, f64)]) -> Self {
        let placement = PartPlacement {
            root_bounds: vec![(-1.0, 1.0); 3],
            ..sample_models::part("human", PartKind::Robot, RootJoint::FreeFlyer, Pose::identity())
        };
        let robot = Robot::compose(&[(model, placement)]).unwrap();
        let frame = |joint: &str| Frame::of_joint(robot.joint(&format!("human/{joint}")).unwrap());
        let (ankles, hand) = (ankles.map(frame), frame(hand));
        let mut standing = robot.space.neutral();
        for (joint, value) in bent {
            let joint = &robot.joints[robot.joint(&format!("human/{joint}")).unwrap().at()];
            let Source::Coordinates { q, .. } = joint.source else { continue };
            standing[q] = *value;
        }
        Self { name, robot, standing, ankles, hand }
    }

    fn sample() -> Self {
        let bent =
            [("hip_pitch", -0.4), ("knee", 0.8), ("ankle_pitch", -0.4), ("shoulder_pitch", -0.4), ("elbow", -1.0)];
        let bent: Vec<_> = ["l", "r"].iter().flat_map(|s| bent.map(|(joint, x)| (format!("{s}_{joint}"), x))).collect();
        let bent: Vec<_> = bent.iter().map(|(joint, x)| (joint.as_str(), *x)).collect();
        Self::new("sample", &sample_models::humanoid(), ["l_ankle_roll", "r_ankle_roll"], "l_wrist_roll", &bent)
    }

    /// `None`, and said so, where the published robots are not at hand.
    fn talos() -> Option<Self> {
        let url = "package://example-robot-data/robots/talos_data/robots/talos_full_v2.urdf";
        let read = match read_model(url, None, &PackagePath::from_environment(&[])) {
            Ok(read) => read,
            Err(error) => {
                skipped("talos", &error.to_string());
                return None;
            }
        };
        let bent = [("3", -0.41), ("4", 0.86), ("5", -0.45)];
        let bent: Vec<_> =
            ["left", "right"].iter().flat_map(|s| bent.map(|(k, x)| (format!("leg_{s}_{k}_joint"), x))).collect();
        let mut bent: Vec<_> = bent.iter().map(|(joint, x)| (joint.as_str(), *x)).collect();
        bent.extend([("arm_left_4_joint", -0.5), ("arm_right_4_joint", -0.5)]);
        let ankles = ["leg_left_6_joint", "leg_right_6_joint"];
        Some(Self::new("talos", &read.model, ankles, "arm_left_7_joint", &bent))
    }

    /// Both feet where they stand, the centre of mass over them where it is, and a hand at an argument: 21 rows. Where the
    /// robot stands on a foot, its root and six of them are eliminated; a foot in two halves, place and turn, is none, so
    /// that what elimination saves can be measured.
    fn program(&self, kinematics: &Kinematics, stands: bool) -> ConstraintProgram {
        let mut bodies = vec![Pose::identity(); kinematics.bodies()];
        kinematics.forward(&self.standing, &mut bodies);
        let world = Frame::world(Pose::identity());
        let foot = |frame: Frame| {
            let there = Reference::Fixed(placement_of(&frame).in_world(&bodies));
            let whole = RelativePose::rigid(world, frame, there);
            let half = |from: usize| {
                let rows = std::array::from_fn(|k| whole.rows[k].filter(|_| (from..from + 3).contains(&k)));
                Constraint::RelativePose(RelativePose { rows, ..whole })
            };
            if stands { vec![Constraint::RelativePose(whole)] } else { vec![half(0), half(3)] }
        };
        let masses = Masses::of_parts(&self.robot, &[PartIndex(0)]).unwrap();
        let plane = |normal| PlaneRow { normal, offset: 0.0, row: Row::Zero };
        let rows = DVec3::AXES.map(plane).to_vec();
        let mut balance = CentreOfMass { masses, frame: self.ankles[0], rows, reference: Reference::Identity };
        let center = centre_of_mass::in_frame(&balance, &bodies);
        balance.rows.iter_mut().for_each(|plane| plane.offset = plane.normal.dot(center));
        let hand = Constraint::RelativePose(RelativePose::rigid(world, self.hand, Reference::Argument(0)));
        let mut constraints = self.ankles.map(foot).concat();
        constraints.extend([Constraint::CentreOfMass(balance), hand]);
        ConstraintProgram::compile(&self.robot, kinematics, &constraints, &[], &[]).unwrap()
    }

    /// Configurations on feet and in balance, and where their hands are.
    fn solutions(&self, kinematics: &Kinematics, program: &ConstraintProgram) -> (Vec<Vec<f64>>, Vec<Pose>) {
        let (mut found, mut hands) = (Vec::new(), Vec::new());
        let (mut scratch, mut bodies) = (Scratch::default(), vec![Pose::identity(); kinematics.bodies()]);
        for random in random_configurations(&self.robot, 20 * BALANCED) {
            let mut q = self.standing.clone();
            self.robot.space.interpolate(&self.standing, &random, 0.2, &mut q);
            kinematics.forward(&q, &mut bodies);
            let target = [placement_of(&self.hand).in_world(&bodies)];
            if found.len() < BALANCED
                && project(program, &mut q, &target, &Settings::default(), &mut scratch).is_converged()
            {
                found.push(q);
                hands.push(target[0]);
            }
        }
        assert_eq!(found.len(), BALANCED, "{}: too few reach a fifth of the way", self.name);
        (found, hands)
    }
}

/// Targets of a humanoid; a multiple of the lanes.
const BALANCED: usize = 256;

fn bench_humanoid(c: &mut Criterion, humanoid: &Humanoid) {
    let kinematics = Kinematics::new(&humanoid.robot);
    let standing = humanoid.program(&kinematics, true);
    let (solutions, targets) = humanoid.solutions(&kinematics, &standing);
    let random = random_configurations(&humanoid.robot, BALANCED);
    let towards = |share: f64| -> Vec<Vec<f64>> {
        let start = |(there, random): (&Vec<f64>, &Vec<f64>)| {
            let mut q = there.clone();
            humanoid.robot.space.interpolate(there, random, share, &mut q);
            q
        };
        solutions.iter().zip(&random).map(start).collect()
    };
    for program in [standing, humanoid.program(&kinematics, false)] {
        let (variables, rows) = program.equations();
        let mut group = c.benchmark_group(format!("projection/{} {variables}x{rows}", humanoid.name));
        group.throughput(Throughput::Elements(BALANCED as u64)).sample_size(20);
        bench_starts(&mut group, "random start", &program, &random, &targets);
        bench_starts(&mut group, "a tenth of the way off", &program, &towards(0.1), &targets);
        bench_starts(&mut group, "a hundredth of the way off", &program, &towards(0.01), &targets);
        group.finish();
    }
}

fn bench(c: &mut Criterion) {
    bench_humanoid(c, &Humanoid::sample());
    Humanoid::talos().iter().for_each(|talos| bench_humanoid(c, talos));
    let model = sample_model();
    let (program, targets) = (reach(&model), top_down_targets());
    assert!(targets.iter().all(|t| pose_to_array(t).iter().all(|x| x.is_finite())));
    let mut group = c.benchmark_group("projection/7x6");
    group.throughput(Throughput::Elements(TRIES as u64)).sample_size(20);
    let random = random_configurations(&model.problem.robot, TRIES);
    bench_starts(&mut group, "random start", &program, &random, &targets);
    bench_starts(&mut group, "seeded start", &program, &seeded(&model, &targets), &targets);
    group.finish();
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
