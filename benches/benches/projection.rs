//! What does it cost to put a seven-joint arm's hand where a top-down grasp wants it: per try, and per success?
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot be set up has nothing to measure")]

use criterion::{BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement};
use foliate_benches::{criterion, random_configurations, sample_model};
use foliate_components::Pose;
use foliate_components::constraint::Constraint;
use foliate_components::constraint::{Frame, Grasp, Reference, RelativePose};
use foliate_components::pose::pose_to_array;
use foliate_kernels::constraints::placement_of;
use foliate_kernels::projection::{
    ArgumentBlock, ConstraintProgram, LANES, LaneBlock, LaneMask, Outcome, Scratch, Settings, project_batch,
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
        "{name}: {:.1} % of {TRIES} tries succeed, {:.1} Newton steps and {:.2} us per try, {:.2} us per success",
        100.0 * f64::from(solved) / TRIES as f64,
        f64::from(iterations) / TRIES as f64,
        best * 1e6 / TRIES as f64,
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

fn bench(c: &mut Criterion) {
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
