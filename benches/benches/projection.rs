//! What does it cost to put a seven-joint arm's hand where a top-down grasp wants it, or where some configuration has it, per
//! try and per success, in double precision and with first steps in single precision; and a humanoid on both feet, in balance,
//! with a hand in place?
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot be set up has nothing to measure")]

use criterion::{BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement};
use foliate_benches::humanoid::{BALANCED, Humanoid};
use foliate_benches::{criterion, random_configurations, sample_model, scene_model};
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Reference, RelativePose};
use foliate_components::pose::pose_to_array;
use foliate_kernels::constrained_motion::{ConstraintProgram, Job, Outcome, Scratch, Settings, project_batch};
use foliate_kernels::constraints::placement_of;
use foliate_kernels::kinematics::Kinematics;
use foliate_kernels::lanes::Level;
use foliate_systems::planning_model::PlanningModel;
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::time::Instant;

/// Targets.
const TRIES: usize = 4096;

/// Where a hand that holds something from above is: over the table in front of a robot, its x axis down, any turn about the
/// vertical. A low-discrepancy sequence, so that the targets are spread evenly and the same in every run. Not all can be
/// reached.
fn top_down_targets(X_WR: &Pose) -> Vec<Pose> {
    let target = |i: usize| {
        let share = |step: f64| (0.5 + i as f64 * step).fract();
        let at =
            DVec3::new(0.35 + 0.6 * share(0.754_877), -0.6 + 1.2 * share(0.569_840), 0.03 + 0.1 * share(0.819_172));
        let turn = DQuat::from_rotation_z(TAU * share(0.671_043)) * DQuat::from_rotation_y(FRAC_PI_2);
        *X_WR * Pose::from_parts(at, turn)
    };
    (0..TRIES).map(target).collect()
}

/// A gripper at a pose that is an argument: six rows, seven columns.
fn reach(model: &PlanningModel, gripper: &str) -> ConstraintProgram {
    let robot = &model.problem.robot;
    let gripper = &robot.grippers[robot.gripper(gripper).unwrap().at()];
    let frame = Frame::on_link(robot, gripper.link, &gripper.link_from_gripper);
    let rows = RelativePose::rigid(Frame::world(Pose::identity()), frame, Reference::Argument(0));
    let program =
        ConstraintProgram::compile(robot, &model.kinematics, &[Constraint::RelativePose(rows)], &[], &[]).unwrap();
    assert_eq!((program.active().len(), program.rows()), (7, 6));
    program
}

/// Random configurations among which a start near its target is looked for.
const SEEDS: usize = 8192;

/// Starts whose hand is as near its target as that of any of many random configurations; a radian counts as 0.3 m. The search does
/// without (docs/decisions/0011): these show what a good start is worth.
fn seeded(model: &PlanningModel, gripper: &str, targets: &[Pose]) -> Vec<Vec<f64>> {
    let seeds = random_configurations(&model.problem.robot, SEEDS);
    let poses = poses_of(model, gripper, &seeds);
    let gap = |pose: &Pose, target: &Pose| {
        let apart = pose.translation.distance_squared(target.translation);
        apart - 4.0 * 0.3 * 0.3 * pose.rotation.dot(target.rotation).powi(2)
    };
    let nearest = |target: &Pose| {
        let gaps = poses.iter().map(|pose| gap(pose, target)).enumerate();
        gaps.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(seed, _)| seed)
    };
    targets.iter().map(|target| seeds[nearest(target)].clone()).collect()
}

/// One pass over all problems: how many succeed, and in how many evaluations of the rows.
fn pass(
    program: &ConstraintProgram,
    starts: &mut [Vec<f64>],
    targets: &[Pose],
    settings: &Settings,
    scratch: &mut Scratch,
) -> (u32, u32) {
    let jobs = starts.iter_mut().zip(targets.chunks(1));
    let mut jobs: Vec<_> = jobs.map(|(q, target)| Job::new(q, target)).collect();
    project_batch(program, &mut jobs, settings, scratch);
    let (mut solved, mut evaluations) = (0, 0);
    for job in &jobs {
        match job.outcome {
            Outcome::Converged { iterations: n, .. } => (solved, evaluations) = (solved + 1, evaluations + n + 1),
            Outcome::Stagnated { iterations: n, .. } => evaluations += n + 1,
            _ => evaluations += settings.iterations + 1,
        }
    }
    (solved, evaluations)
}

/// Where single precision hands over to double.
const SINGLE_UNTIL: f64 = 1e-4;

/// Problems between two readings of the clock: few enough for one time slice on a busy machine.
const SLICE: usize = 256;

fn bench_starts(
    group: &mut BenchmarkGroup<'_, measurement::WallTime>,
    name: &str,
    program: &ConstraintProgram,
    starts: &[Vec<f64>],
    targets: &[Pose],
) {
    let mut scratch = Scratch::default();
    let levels = if program.is_for_lanes() { Level::available() } else { vec![Level::scalar()] };
    let scalar = |level: &Level| *level == Level::scalar();
    let precisions = levels.into_iter().flat_map(|level| {
        let single = (!scalar(&level)).then_some((level, SINGLE_UNTIL, ", single precision first"));
        std::iter::once((level, 0.0, "")).chain(single)
    });
    for (level, single_until, how) in precisions {
        let settings = Settings { level, single_until, ..Settings::default() };
        let (mut time, mut solved, mut evaluations) = (0.0, 0, 0);
        for (starts, targets) in starts.chunks(SLICE).zip(targets.chunks(SLICE)) {
            let mut best = f64::INFINITY;
            let mut counts = (0, 0);
            for _ in 0..20 {
                let mut fresh = starts.to_vec();
                let started = Instant::now();
                counts = pass(program, &mut fresh, targets, &settings, &mut scratch);
                best = best.min(started.elapsed().as_secs_f64());
            }
            (time, solved, evaluations) = (time + best, solved + counts.0, evaluations + counts.1);
        }
        println!(
            "{name}, {level}{how}: of {} tries {:.1} % succeed; {:.1} evaluations and {:.2} us per try, {:.2} us per success, \
             {:.0} ns per evaluation and step",
            starts.len(),
            100.0 * f64::from(solved) / starts.len() as f64,
            f64::from(evaluations) / starts.len() as f64,
            time * 1e6 / starts.len() as f64,
            time * 1e6 / f64::from(solved.max(1)),
            time * 1e9 / f64::from(evaluations.max(1)),
        );
        group.bench_function(format!("{name}, {level}{how}"), |b| {
            b.iter_batched_ref(
                || starts.to_vec(),
                |starts| pass(program, starts, targets, &settings, &mut scratch),
                BatchSize::LargeInput,
            );
        });
    }
}

fn bench_humanoid(c: &mut Criterion, humanoid: &Humanoid) {
    let kinematics = Kinematics::new(&humanoid.robot);
    let standing = humanoid.program(&kinematics, true, true);
    let (solutions, targets) = humanoid.solutions(&kinematics, &standing, 0.2);
    let random = random_configurations(&humanoid.robot, BALANCED);
    let towards = |share: f64| -> Vec<Vec<f64>> {
        let start = |(there, random): (&Vec<f64>, &Vec<f64>)| {
            let mut q = there.clone();
            humanoid.robot.space.interpolate(there, random, share, &mut q);
            q
        };
        solutions.iter().zip(&random).map(start).collect()
    };
    for program in [standing, humanoid.program(&kinematics, false, true)] {
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
    bench_reach(c, "sample arm", &sample_model(), "arm/hand", &Pose::identity());
    // The shoulders stand over the pedestal, a table's top a little below them.
    let baxter = scene_model("baxter-case4");
    let below = Pose::from_translation(DVec3::new(-0.8, 0.8, 0.726));
    baxter.iter().for_each(|model| bench_reach(c, "baxter", model, "baxter/l_gripper", &below));
}

fn bench_reach(c: &mut Criterion, name: &str, model: &PlanningModel, gripper: &str, X_WR: &Pose) {
    let (program, targets) = (reach(model, gripper), top_down_targets(X_WR));
    assert!(targets.iter().all(|t| pose_to_array(t).iter().all(|x| x.is_finite())));
    let mut group = c.benchmark_group(format!("projection/{name} 7x6"));
    group.throughput(Throughput::Elements(TRIES as u64)).sample_size(20);
    let random = random_configurations(&model.problem.robot, TRIES);
    let reached = within_reach(&program, &random, &targets);
    let near: Vec<Pose> = targets.iter().zip(&reached).filter(|(_, reached)| **reached).map(|(t, _)| *t).collect();
    let share = 100.0 * near.len() as f64 / targets.len() as f64;
    println!("{name}: {share:.1} % of the targets from above are within reach");
    let there = poses_of(model, gripper, &random_configurations(&model.problem.robot, 2 * TRIES)[TRIES..]);
    let kinds = [("from above", &targets), ("from above within reach", &near), ("where it can be", &there)];
    for (what, targets) in kinds {
        let random = &random[..targets.len()];
        bench_starts(&mut group, &format!("{what}, random start"), &program, random, targets);
        let seeded = seeded(model, gripper, targets);
        bench_starts(&mut group, &format!("{what}, seeded start"), &program, &seeded, targets);
    }
    group.finish();
}

/// Where the gripper is in configurations.
fn poses_of(model: &PlanningModel, gripper: &str, configurations: &[Vec<f64>]) -> Vec<Pose> {
    let robot = &model.problem.robot;
    let gripper = &robot.grippers[robot.gripper(gripper).unwrap().at()];
    let frame = placement_of(&Frame::on_link(robot, gripper.link, &gripper.link_from_gripper));
    let mut bodies = vec![Pose::identity(); model.kinematics.bodies()];
    let pose = |q: &Vec<f64>| {
        model.kinematics.forward(q, &mut bodies);
        frame.in_world(&bodies)
    };
    configurations.iter().map(pose).collect()
}

/// Which targets are reached from any of 64 starts.
fn within_reach(program: &ConstraintProgram, starts: &[Vec<f64>], targets: &[Pose]) -> Vec<bool> {
    let (mut scratch, mut reached) = (Scratch::default(), vec![false; targets.len()]);
    for shift in 0..64 {
        let mut starts = starts.to_vec();
        starts.rotate_left(shift);
        let mut jobs: Vec<_> =
            starts.iter_mut().zip(targets.chunks(1)).map(|(q, target)| Job::new(q, target)).collect();
        project_batch(program, &mut jobs, &Settings::default(), &mut scratch);
        reached.iter_mut().zip(&jobs).for_each(|(reached, job)| *reached |= job.outcome.is_converged());
    }
    reached
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
