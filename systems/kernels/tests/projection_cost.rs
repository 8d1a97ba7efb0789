//! What the hot loops cost. Run with `cargo test --release --test projection_cost -- --ignored --nocapture`.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

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
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::hint::black_box;
use std::time::Instant;

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

fn randoms(robot: &Robot, count: usize) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let one = |_| {
        let mut q = robot.space.neutral();
        robot.space.random(&mut rng, &mut q);
        q
    };
    (0..count).map(one).collect()
}

/// Solves from every start; prints time per try and per iteration.
fn time_solves(what: &str, program: &ConstraintProgram, starts: &[Vec<f64>], arguments: &[Vec<Pose>]) {
    let mut scratch = Scratch::default();
    let settings = Settings::default();
    let mut best = f64::INFINITY;
    let (mut solved, mut iterations) = (0, 0);
    for _ in 0..5 {
        (solved, iterations) = (0, 0);
        let start = Instant::now();
        let mut q = starts[0].clone();
        for (from, arguments) in starts.iter().zip(arguments) {
            q.copy_from_slice(from);
            match black_box(project(program, &mut q, arguments, &settings, &mut scratch)) {
                Outcome::Converged { iterations: n, .. } => (solved, iterations) = (solved + 1, iterations + n + 1),
                Outcome::Stagnated { iterations: n, .. } => iterations += n + 1,
                _ => iterations += settings.iterations + 1,
            }
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    let tries = starts.len() as f64;
    println!(
        "{what}: {}x{}, success {:.3}, {:.1} evaluations and {:.2} us per try, {:.2} us per success, {:.0} ns per evaluation",
        program.active().len(),
        program.rows(),
        f64::from(solved) / tries,
        f64::from(iterations) / tries,
        best * 1e6 / tries,
        best * 1e6 / f64::from(solved),
        best * 1e9 / f64::from(iterations),
    );
}

#[test]
#[ignore = "a measurement, not a test"]
fn measure() {
    let robot = workcell();
    let kinematics = Kinematics::new(&robot);
    let compile = |c: &[Constraint]| ConstraintProgram::compile(&robot, &kinematics, c, &[], &[]).unwrap();
    let starts = randoms(&robot, 4096);
    let targets = randoms(&robot, 8192).split_off(4096);
    let grasp = |g: &str| Grasp::new(&robot, robot.gripper(g).unwrap(), robot.handle("block/top").unwrap()).unwrap();
    let (left, right) = (grasp("left/hand"), grasp("right/hand"));

    let tip = placement_of(&left.gripper);
    let columns = AttachmentTree::new(&robot).columns(None, tip.joint, |v| (v < 7).then_some(v));
    let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
    let (mut jacobian, start) = ([0.0; 42], Instant::now());
    for q in &starts {
        kinematics.forward(q, &mut X_WJ);
        let point = tip.in_world(&X_WJ).translation;
        geometric_jacobian(&columns, &X_WJ, point, &mut jacobian);
        black_box(&jacobian);
    }
    println!("whole tree (16 bodies) + Jacobian of one arm: {:.0} ns", start.elapsed().as_secs_f64() * 1e9 / 4096.0);

    let reach = RelativePose::rigid(Frame::world(Pose::identity()), left.gripper, Reference::Argument(0));
    let program = compile(&[Constraint::RelativePose(reach)]);
    let mut scratch = Scratch::default();
    let (arguments, start) = ([Pose::identity()], Instant::now());
    for q in &starts {
        black_box(program.residual(q, &arguments, &mut scratch));
    }
    println!("arm + Jacobian + six rows: {:.0} ns", start.elapsed().as_secs_f64() * 1e9 / 4096.0);

    let poses: Vec<Vec<Pose>> = targets
        .iter()
        .map(|q| {
            kinematics.forward(q, &mut X_WJ);
            vec![tip.in_world(&X_WJ)]
        })
        .collect();
    time_solves("reach", &program, &starts, &poses);

    let none = vec![Vec::new(); starts.len()];
    let surface = |name| robot.surface(name).unwrap();
    let contact = Contact::new(&robot, &[surface("block/bottom")], &[surface("table/top")], 1e-3).unwrap();
    let both = [Constraint::Placement(contact), Constraint::RelativePose(left.constraint())];
    time_solves("grasp and placement", &compile(&both), &starts, &none);

    let opposite = Pose::from_rotation(exp_so3(DVec3::Y * std::f64::consts::PI));
    let right = RelativePose { b: right.handle.then(&opposite), ..right.constraint() };
    let two_hands = compile(&[Constraint::RelativePose(left.constraint()), Constraint::RelativePose(right)]);
    time_solves("two hands", &two_hands, &starts, &none);
    time_motions(&robot, &two_hands, &starts);
}

fn time_motions(robot: &Robot, program: &ConstraintProgram, starts: &[Vec<f64>]) {
    let (settings, mut solver) = (Settings::default(), Scratch::default());
    let (mut scratch, mut knots) = (MotionScratch::default(), Vec::new());
    let mut ends: Vec<Vec<f64>> = starts.to_vec();
    ends.retain_mut(|q| project(program, q, &[], &settings, &mut solver).is_converged());
    ends.truncate(400);
    let near: Vec<_> = ends
        .iter()
        .filter_map(|q| {
            let mut moved: Vec<f64> = q.iter().enumerate().map(|(i, x)| x + 0.2 * (i as f64).sin()).collect();
            project(program, &mut moved, &[], &settings, &mut solver).is_converged().then(|| (q.clone(), moved))
        })
        .collect();
    let start = Instant::now();
    for (from, to) in &near {
        let _ = black_box(project_motion(
            program,
            &robot.space,
            (from, to),
            &[],
            &MotionSettings::default(),
            &mut scratch,
            &mut knots,
        ));
    }
    let count = knots.len() / robot.space.size();
    println!("two-hand motions: {:.2} us per knot, {count} knots", start.elapsed().as_secs_f64() * 1e6 / count as f64);
}
