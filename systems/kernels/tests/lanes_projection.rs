//! Projection in lanes finds what the scalar code finds, and what becomes of a problem depends on that problem alone.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Grasp, Placement as Contact, Reference, RelativePose, Row};
use foliate_components::pose::exp_so3;
use foliate_components::robot::Robot;
use foliate_components::samples::models;
use foliate_kernels::constrained_motion::{
    AttachmentTemplate, ConstraintProgram, Job, Outcome, Scratch, Settings, project, project_batch,
};
use foliate_kernels::constraints::{placement, placement_of};
use foliate_kernels::kinematics::Kinematics;
use foliate_kernels::lanes::Level;
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Starts and arguments.
type Problems = Vec<(Vec<f64>, Vec<Pose>)>;

/// Two arms, two blocks with several surfaces, a table in two halves.
struct Cell {
    robot: Robot,
    kinematics: Kinematics,
    rng: ChaCha8Rng,
}

impl Cell {
    fn new() -> Self {
        let arm = models::seven_axis_arm();
        let (block, table) = (models::block(DVec3::new(0.06, 0.06, 0.12)), models::table(DVec3::new(0.6, 0.6, 0.05)));
        let at = |x, y, z| Pose::from_translation(DVec3::new(x, y, z));
        let robot = Robot::compose(&[
            (&arm, models::fixed_robot("left", at(0.0, 0.3, 0.0))),
            (&arm, models::fixed_robot("right", at(0.0, -0.3, 0.0))),
            (&block, models::movable_object("block")),
            (&block, models::movable_object("other")),
            (&table, models::environment("table", at(0.8, 0.35, -0.1))),
            (&table, models::environment("shelf", at(0.8, -0.35, -0.2))),
        ])
        .unwrap();
        Self { kinematics: Kinematics::new(&robot), robot, rng: ChaCha8Rng::seed_from_u64(5) }
    }

    fn random(&mut self) -> Vec<f64> {
        let mut q = self.robot.space.neutral();
        self.robot.space.random(&mut self.rng, &mut q);
        q
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut X_WJ = vec![Pose::identity(); self.kinematics.bodies()];
        self.kinematics.forward(q, &mut X_WJ);
        X_WJ
    }

    fn grasp(&self, gripper: &str, handle: &str) -> Grasp {
        let robot = &self.robot;
        Grasp::new(robot, robot.gripper(gripper).unwrap(), robot.handle(handle).unwrap()).unwrap()
    }

    fn contact(&self, object: &str) -> Contact {
        let surface = |name: &str| self.robot.surface(name).unwrap();
        let supports = [surface("table/top"), surface("shelf/top")];
        Contact::new(&self.robot, &[surface(&format!("{object}/bottom"))], &supports, 1e-3).unwrap()
    }

    fn compile(&self, constraints: &[Constraint], rigid_attachments: &[AttachmentTemplate]) -> ConstraintProgram {
        ConstraintProgram::compile(&self.robot, &self.kinematics, constraints, rigid_attachments, &[]).unwrap()
    }

    /// Programs with problems that can be solved: starts and arguments.
    fn programs(&mut self) -> Vec<(&'static str, ConstraintProgram, Problems)> {
        let grasp = self.grasp("left/hand", "block/top");
        let second = self.grasp("right/hand", "block/top");
        let gripper = placement_of(&grasp.gripper);
        let contact = self.contact("block");
        let block = self.robot.joint("block/root_joint").unwrap();
        let placed = AttachmentTemplate::argument(block, None, 0);
        let rigid = RelativePose::rigid(Frame::world(Pose::identity()), grasp.gripper, Reference::Argument(0));
        let apart = Pose::from_parts(DVec3::new(0.0, 0.0, 0.25), exp_so3(DVec3::new(0.0, 2.0, 0.0)));
        let mut above = RelativePose::rigid(grasp.gripper, Frame::world(Pose::identity()), Reference::Fixed(apart));
        above.rows = [Some(Row::Zero), None, Some(Row::Inequality), None, Some(Row::Zero), None];
        let both = RelativePose::rigid(grasp.gripper, second.gripper, Reference::Fixed(apart));
        let placed_at = Constraint::PlacementHold(contact.clone(), 0);
        let X_CO = gripper.X_JF * placement_of(&grasp.handle).X_JF.inverse();
        let in_hand = AttachmentTemplate::fixed(block, gripper.joint, X_CO);
        let laid = Constraint::Placement(contact.clone());
        let held = Constraint::RelativePose(grasp.constraint());
        let programs = [
            ("reach", self.compile(&[Constraint::RelativePose(rigid)], &[])),
            ("grasp what lies", self.compile(std::slice::from_ref(&held), &[placed])),
            ("put down", self.compile(&[held.clone(), Constraint::Placement(contact)], &[])),
            ("put down there", self.compile(&[held, placed_at], &[])),
            ("some rows", self.compile(&[Constraint::RelativePose(above)], &[])),
            ("hand to hand", self.compile(&[Constraint::RelativePose(both)], &[])),
            ("lay down what is held", self.compile(&[laid], &[in_hand])),
        ];
        let mut found = Vec::new();
        for (name, program) in programs {
            let mut problems = Vec::new();
            for _ in 0..150 {
                let q = self.random();
                let X_WJ = self.poses(&q);
                let target = match name {
                    "grasp what lies" => {
                        // Where the hand of some configuration would hold it.
                        let X_GO = placement_of(&grasp.handle).X_JF.inverse();
                        gripper.in_world(&X_WJ) * X_GO
                    }
                    "put down there" => {
                        let y = -0.2 + 0.4 * (problems.len() as f64 / 150.0);
                        Pose::from_parts(DVec3::new(0.0, y, 0.1), exp_so3(DVec3::X * (6.0 * y)))
                    }
                    _ => gripper.in_world(&X_WJ),
                };
                problems.push((self.random(), vec![target]));
            }
            found.push((name, program, problems));
        }
        found
    }
}

/// Where single precision hands over.
const SINGLE: f64 = 1e-4;

fn solve(
    program: &ConstraintProgram,
    problems: &[(Vec<f64>, Vec<Pose>)],
    settings: &Settings,
) -> Vec<(Vec<f64>, Outcome)> {
    let mut starts: Vec<Vec<f64>> = problems.iter().map(|(q, _)| q.clone()).collect();
    let mut jobs: Vec<_> = starts.iter_mut().zip(problems).map(|(q, (_, arguments))| Job::new(q, arguments)).collect();
    project_batch(program, &mut jobs, settings, &mut Scratch::default());
    let outcomes: Vec<_> = jobs.iter().map(|job| job.outcome).collect();
    starts.into_iter().zip(outcomes).collect()
}

fn same(a: &(Vec<f64>, Outcome), b: &(Vec<f64>, Outcome)) -> bool {
    a.1 == b.1 && a.0.iter().zip(&b.0).all(|(x, y)| x.to_bits() == y.to_bits())
}

#[test]
fn a_problem_alone_and_in_a_crowd_ends_in_the_same_bits() {
    let mut cell = Cell::new();
    for (name, program, problems) in cell.programs() {
        assert!(program.is_for_lanes(), "{name}");
        for level in Level::available() {
            for single_until in [0.0, SINGLE] {
                let settings = Settings { level, single_until, ..Settings::default() };
                let all = solve(&program, &problems, &settings);
                let backwards: Vec<_> = problems.iter().rev().cloned().collect();
                let backwards = solve(&program, &backwards, &settings);
                for (k, one) in all.iter().enumerate() {
                    assert!(same(one, &backwards[problems.len() - 1 - k]), "{name}, {level}: order matters to {k}");
                }
                for k in (0..problems.len()).step_by(7) {
                    let alone = solve(&program, &problems[k..=k], &settings);
                    assert!(same(&all[k], &alone[0]), "{name}, {level}: a crowd matters to {k}");
                }
                for count in [2, 3, 8, 9] {
                    let few = solve(&program, &problems[20..20 + count], &settings);
                    assert!(few.iter().zip(&all[20..]).all(|(a, b)| same(a, b)), "{name}, {level}: {count}");
                }
            }
        }
    }
}

#[test]
fn what_lanes_find_satisfies_the_scalar_code_and_is_found_as_often() {
    let mut cell = Cell::new();
    for (name, program, problems) in cell.programs() {
        let scalar = solve(&program, &problems, &Settings { level: Level::scalar(), ..Settings::default() });
        let expected = scalar.iter().filter(|(_, outcome)| outcome.is_converged()).count();
        assert!(expected > 15, "{name}: {expected} of {}", problems.len());
        for level in Level::available() {
            let found = solve(&program, &problems, &Settings { level, ..Settings::default() });
            let count = found.iter().filter(|(_, outcome)| outcome.is_converged()).count();
            assert!(count.abs_diff(expected) <= 8, "{name}, {level}: {count} against {expected}");
            let mut scratch = Scratch::default();
            for ((q, outcome), (_, arguments)) in found.iter().zip(&problems) {
                let Outcome::Converged { residual, .. } = outcome else { continue };
                let deviation = program.deviation(q, arguments, &mut scratch).unwrap();
                assert!((deviation.rows - residual).abs() < 1e-9, "{name}, {level}: {deviation:?} {residual}");
                assert!(deviation.objects < 1e-15, "{name}, {level}: {deviation:?}");
                let space = &cell.robot.space;
                for &v in program.active() {
                    // The arms come first, one coordinate each.
                    assert!(q[v] >= space.lower[v] && q[v] <= space.upper[v], "{name}, {level}");
                }
            }
        }
    }
}

#[test]
fn single_precision_first_finds_as_much_and_double_precision_judges_it() {
    let mut cell = Cell::new();
    for (name, program, problems) in cell.programs() {
        for level in Level::available().into_iter().filter(|level| *level != Level::scalar()) {
            let double = Settings { level, ..Settings::default() };
            let single = Settings { single_until: SINGLE, ..double };
            let (expected, found) = (solve(&program, &problems, &double), solve(&program, &problems, &single));
            let count = |solved: &[(Vec<f64>, Outcome)]| solved.iter().filter(|(_, o)| o.is_converged()).count();
            assert!(count(&found).abs_diff(count(&expected)) <= 8, "{name}, {level}");
            let bits = |q: &[f64]| q.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert!(
                expected.iter().zip(&found).any(|(a, b)| bits(&a.0) != bits(&b.0)),
                "{name}, {level}: never single"
            );
            let mut scratch = Scratch::default();
            for ((q, outcome), (_, arguments)) in found.iter().zip(&problems) {
                let Outcome::Converged { residual, iterations } = *outcome else { continue };
                assert!(
                    residual <= single.tolerance && iterations <= single.iterations,
                    "{name}, {level}: {outcome:?}"
                );
                let deviation = program.deviation(q, arguments, &mut scratch).unwrap();
                assert!((deviation.rows - residual).abs() < 1e-9, "{name}, {level}: {deviation:?} {residual}");
                let space = &cell.robot.space;
                assert!(program.active().iter().all(|&v| q[v] >= space.lower[v] && q[v] <= space.upper[v]), "{name}");
            }
            // What holds already keeps all its digits.
            let solved = found.iter().zip(&problems).filter(|((_, outcome), _)| outcome.is_converged());
            let solved: Vec<_> = solved.map(|((q, _), (_, arguments))| (q.clone(), arguments.clone())).collect();
            for ((q, outcome), (start, _)) in solve(&program, &solved, &single).iter().zip(&solved) {
                assert!(matches!(outcome, Outcome::Converged { iterations: 0, .. }), "{name}, {level}: {outcome:?}");
                assert_eq!(bits(q), bits(start), "{name}, {level}");
            }
        }
    }
}

#[test]
fn what_single_precision_has_no_digits_for_is_solved_in_double_precision() {
    let mut cell = Cell::new();
    let (_, program, mut problems) = cell.programs().swap_remove(0);
    for (_, arguments) in problems.iter_mut().step_by(3) {
        arguments[0].translation.x += 1e3;
    }
    for level in Level::available() {
        let double = Settings { level, ..Settings::default() };
        let expected = solve(&program, &problems, &double);
        let found = solve(&program, &problems, &Settings { single_until: SINGLE, ..double });
        for (k, (found, expected)) in found.iter().zip(&expected).enumerate().step_by(3) {
            assert!(same(found, expected), "{level}: {k}");
        }
    }
}

#[test]
fn from_nearby_lanes_and_scalar_code_take_the_same_steps() {
    let mut cell = Cell::new();
    for (name, program, problems) in cell.programs() {
        let solved = solve(&program, &problems, &Settings { level: Level::scalar(), ..Settings::default() });
        let near: Vec<_> = solved
            .iter()
            .zip(&problems)
            .filter(|((_, outcome), _)| outcome.is_converged())
            .map(|((q, _), (other, arguments))| {
                let mut start = q.clone();
                cell.robot.space.interpolate(q, other, 0.02, &mut start);
                (start, arguments.clone())
            })
            .collect();
        for level in Level::available() {
            let found = solve(&program, &near, &Settings { level, ..Settings::default() });
            let mut agree = 0;
            for ((q, outcome), (start, arguments)) in found.iter().zip(&near) {
                let mut expected = start.clone();
                let scalar = project(&program, &mut expected, arguments, &Settings::default(), &mut Scratch::default());
                let close = q.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-7);
                let steps = |outcome: &Outcome| match outcome {
                    Outcome::Converged { iterations, .. } => Some(*iterations),
                    _ => None,
                };
                agree += usize::from(close && steps(outcome) == steps(&scalar));
            }
            // A problem on the border between two solutions may go either way.
            assert!(agree * 100 >= near.len() * 95, "{name}, {level}: {agree} of {}", near.len());
        }
    }
}

#[test]
fn a_start_that_is_half_a_turn_off_is_not_taken_for_a_solution() {
    let mut cell = Cell::new();
    let grasp = cell.grasp("left/hand", "block/top");
    let gripper = placement_of(&grasp.gripper);
    let rigid = RelativePose::rigid(Frame::world(Pose::identity()), grasp.gripper, Reference::Argument(0));
    let program = cell.compile(&[Constraint::RelativePose(rigid)], &[]);
    let mut problems = Vec::new();
    for k in 0..60 {
        let q = cell.random();
        let axis = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.0, 0.8)][k % 4];
        let X_WT = gripper.in_world(&cell.poses(&q)) * Pose::from_rotation(exp_so3(axis * std::f64::consts::PI));
        problems.push((q, vec![X_WT]));
    }
    for level in Level::available() {
        let found = solve(&program, &problems, &Settings { level, ..Settings::default() });
        let mut moved = 0;
        for ((q, outcome), (start, arguments)) in found.iter().zip(&problems) {
            if outcome.is_converged() {
                let deviation = program.deviation(q, arguments, &mut Scratch::default()).unwrap();
                assert!(deviation.rows < 1.1e-6, "{level}: {deviation:?}");
            }
            moved += usize::from(q != start);
        }
        assert!(moved > 55, "{level}: {moved}");
    }
}

#[test]
fn what_does_not_fit_is_reported_and_delays_no_other() {
    let mut cell = Cell::new();
    let (_, program, mut problems) = cell.programs().swap_remove(0);
    let expected = solve(&program, &problems, &Settings::default());
    problems[3].1[0].translation.x = f64::NAN;
    problems[11].0[2] = f64::INFINITY;
    problems[12].0.pop();
    problems[13].1.clear();
    let found = solve(&program, &problems, &Settings::default());
    for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
        if [3, 11, 12, 13].contains(&k) {
            assert_eq!(found.1, Outcome::Malformed, "{k}");
        } else {
            assert!(same(found, expected), "{k}");
        }
    }
    assert!(solve(&program, &[], &Settings::default()).is_empty());
}

#[test]
fn an_object_ends_where_a_parameter_of_contact_says() {
    // The hold that a parameter names is where lanes put the object: here six rows, for the hand carries it.
    let mut cell = Cell::new();
    let contact = cell.contact("block");
    let block = cell.robot.joint("block/root_joint").unwrap();
    let (name, program, problems) = cell.programs().swap_remove(3);
    assert_eq!(name, "put down there");
    for ((q, outcome), (_, arguments)) in solve(&program, &problems, &Settings::default()).iter().zip(&problems) {
        if outcome.is_converged() {
            let (_, X_WO) = placement::hold(&contact, &arguments[0]).unwrap();
            let found = cell.poses(q)[block.at()];
            assert!((found.translation - X_WO.translation).length() < 1e-5);
        }
    }
}
