//! What do the inner loops of a projection cost, one problem at a time: poses and a Jacobian, the rows of a program, solves of
//! three programs of two arms, and a motion that is followed on its leaf?
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "a bench that cannot be set up has nothing to measure")]

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement};
use foliate_benches::{criterion, random_configurations};
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Grasp, Placement as Contact, Reference, RelativePose};
use foliate_components::pose::exp_so3;
use foliate_components::robot::Robot;
use foliate_components::samples::models;
use foliate_kernels::constrained_motion::{
    ConstraintProgram, MotionScratch, MotionSettings, Outcome, Scratch, Settings, project, project_motion,
};
use foliate_kernels::constraints::placement_of;
use foliate_kernels::kinematics::{AttachmentTree, Kinematics, geometric_jacobian};
use glam::DVec3;
use std::hint::black_box;

/// Starts, and as many targets.
const TRIES: usize = 4096;

type Group<'a> = BenchmarkGroup<'a, measurement::WallTime>;

/// Two seven-axis arms, two blocks and a table: sixteen bodies.
fn workcell() -> Robot {
    let arm = models::seven_axis_arm();
    let (block, table) = (models::block(DVec3::new(0.06, 0.06, 0.12)), models::table(DVec3::new(0.6, 1.2, 0.05)));
    let at = |x, y, z| Pose::from_translation(DVec3::new(x, y, z));
    Robot::compose(&[
        (&arm, models::fixed_robot("left", at(0.0, 0.3, 0.0))),
        (&arm, models::fixed_robot("right", at(0.0, -0.3, 0.0))),
        (&block, models::movable_object("block")),
        (&block, models::movable_object("other")),
        (&table, models::environment("table", at(0.8, 0.0, -0.1))),
    ])
    .unwrap()
}

/// Solves from every start: how many succeed, and in how many evaluations of the rows.
fn pass(
    program: &ConstraintProgram,
    starts: &[Vec<f64>],
    arguments: &[Vec<Pose>],
    scratch: &mut Scratch,
) -> (u32, u32) {
    let settings = Settings::default();
    let (mut solved, mut evaluations) = (0, 0);
    let mut q = starts[0].clone();
    for (from, arguments) in starts.iter().zip(arguments) {
        q.copy_from_slice(from);
        match black_box(project(program, &mut q, arguments, &settings, scratch)) {
            Outcome::Converged { iterations: n, .. } => (solved, evaluations) = (solved + 1, evaluations + n + 1),
            Outcome::Stagnated { iterations: n, .. } => evaluations += n + 1,
            _ => evaluations += settings.iterations + 1,
        }
    }
    (solved, evaluations)
}

fn bench_solves(
    group: &mut Group<'_>,
    name: &str,
    program: &ConstraintProgram,
    starts: &[Vec<f64>],
    arguments: &[Vec<Pose>],
) {
    let mut scratch = Scratch::default();
    let (solved, evaluations) = pass(program, starts, arguments, &mut scratch);
    let tries = starts.len() as f64;
    println!(
        "{name}, {}x{}: of {tries} tries {:.1} % succeed; {:.1} evaluations per try",
        program.active().len(),
        program.rows(),
        100.0 * f64::from(solved) / tries,
        f64::from(evaluations) / tries,
    );
    group.throughput(Throughput::Elements(starts.len() as u64)).sample_size(20);
    group.bench_function(name, |b| b.iter(|| pass(program, starts, arguments, &mut scratch)));
}

fn bench(c: &mut Criterion) {
    let robot = workcell();
    let kinematics = Kinematics::new(&robot);
    let compile = |c: &[Constraint]| ConstraintProgram::compile(&robot, &kinematics, c, &[], &[]).unwrap();
    let mut starts = random_configurations(&robot, 2 * TRIES);
    let targets = starts.split_off(TRIES);
    let grasp = |g: &str| Grasp::new(&robot, robot.gripper(g).unwrap(), robot.handle("block/top").unwrap()).unwrap();
    let (left, right) = (grasp("left/hand"), grasp("right/hand"));
    let mut group = c.benchmark_group("newton");

    let tip = placement_of(&left.gripper);
    let columns = AttachmentTree::new(&robot).columns(None, tip.joint, |v| (v < 7).then_some(v));
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    let (mut jacobian, mut next) = ([0.0; 42], starts.iter().cycle());
    group.bench_function("poses of all bodies and the Jacobian of one arm", |b| {
        b.iter(|| {
            kinematics.forward(next.next().unwrap(), &mut X_WJ);
            let point = tip.in_world(&X_WJ).translation;
            geometric_jacobian(&columns, &X_WJ, point, &mut jacobian);
            black_box(&jacobian);
        });
    });

    let reach = RelativePose::rigid(Frame::world(Pose::identity()), left.gripper, Reference::Argument(0));
    let program = compile(&[Constraint::RelativePose(reach)]);
    let (mut scratch, mut next) = (Scratch::default(), starts.iter().cycle());
    group.bench_function("six rows of one arm", |b| {
        b.iter(|| program.residual(next.next().unwrap(), &[Pose::identity()], &mut scratch));
    });

    let pose = |q: &Vec<f64>| {
        kinematics.forward(q, &mut X_WJ);
        vec![tip.in_world(&X_WJ)]
    };
    let poses: Vec<Vec<Pose>> = targets.iter().map(pose).collect();
    bench_solves(&mut group, "reach", &program, &starts, &poses);

    let none = vec![Vec::new(); starts.len()];
    let surface = |name| robot.surface(name).unwrap();
    let contact = Contact::new(&robot, &[surface("block/bottom")], &[surface("table/top")], 1e-3).unwrap();
    let both = [Constraint::Placement(contact), Constraint::RelativePose(left.constraint())];
    bench_solves(&mut group, "grasp and placement", &compile(&both), &starts, &none);

    let opposite = Pose::from_rotation(exp_so3(DVec3::Y * std::f64::consts::PI));
    let right = RelativePose { b: right.handle.then(&opposite), ..right.constraint() };
    let two_hands = compile(&[Constraint::RelativePose(left.constraint()), Constraint::RelativePose(right)]);
    bench_solves(&mut group, "two hands", &two_hands, &starts, &none);
    bench_motions(&mut group, &robot, &two_hands, &starts);
    group.finish();
}

/// Motions of two hands on one block, to be read per knot.
fn bench_motions(group: &mut Group<'_>, robot: &Robot, program: &ConstraintProgram, starts: &[Vec<f64>]) {
    let (settings, mut solver) = (Settings::default(), Scratch::default());
    let mut ends: Vec<Vec<f64>> = starts.to_vec();
    ends.retain_mut(|q| project(program, q, &[], &settings, &mut solver).is_converged());
    ends.truncate(400);
    let mut moved = |q: &Vec<f64>| {
        let mut moved: Vec<f64> = q.iter().enumerate().map(|(i, x)| x + 0.2 * (i as f64).sin()).collect();
        project(program, &mut moved, &[], &settings, &mut solver).is_converged().then(|| (q.clone(), moved))
    };
    let near: Vec<_> = ends.iter().filter_map(&mut moved).collect();
    let (mut scratch, motion) = (MotionScratch::default(), MotionSettings::default());
    let mut follow = || {
        let mut knots = Vec::new();
        for (from, to) in &near {
            let ends = (from.as_slice(), to.as_slice());
            let _ = black_box(project_motion(program, &robot.space, ends, &[], &motion, &mut scratch, &mut knots));
        }
        knots.len() / robot.space.size()
    };
    group.throughput(Throughput::Elements(follow() as u64)).sample_size(20);
    group.bench_function("motions of two hands, per knot", |b| b.iter(&mut follow));
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
