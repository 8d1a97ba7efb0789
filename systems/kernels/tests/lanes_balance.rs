//! Humanoids in lanes: the way from a foot back to the root, centres of mass and what feet hold are solved side by side, and
//! end where the scalar code ends.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod heavy_world;

use foliate_components::Pose;
use foliate_components::constraint::{
    CentreOfMass, CentreOfMassBetween, Constraint, Frame, Masses, PlaneRow, Reference, RelativePose, Row,
};
use foliate_components::pose::exp_so3;
use foliate_components::robot::{JointIndex, PartKind, PartPlacement, Robot, RootJoint};
use foliate_components::samples::models;
use foliate_kernels::constrained_motion::{ConstraintProgram, Job, Outcome, Scratch, Settings, project, project_batch};
use foliate_kernels::constraints::centre_of_mass;
use foliate_kernels::kinematics::Kinematics;
use foliate_kernels::lanes::Level;
use glam::DVec3;
use heavy_world::{bent_knees, flying_human};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Starts and arguments.
type Problems = Vec<(Vec<f64>, Vec<Pose>)>;

struct Stage {
    robot: Robot,
    kinematics: Kinematics,
    rng: ChaCha8Rng,
    /// With bent knees.
    standing: Vec<f64>,
}

impl Stage {
    fn new(root: f64) -> Self {
        let human = flying_human(root);
        let block = models::block(DVec3::new(0.1, 0.1, 0.2));
        let robot = Robot::compose(&[(&models::humanoid(), human), (&block, models::movable_object("box"))]).unwrap();
        let standing = bent_knees(&robot);
        Self { kinematics: Kinematics::new(&robot), robot, rng: ChaCha8Rng::seed_from_u64(9), standing }
    }

    fn joint(&self, name: &str) -> JointIndex {
        self.robot.joint(&format!("human/{name}")).unwrap()
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut X_WJ = vec![Pose::identity(); self.kinematics.bodies()];
        self.kinematics.forward(q, &mut X_WJ);
        X_WJ
    }

    fn at(&self, name: &str, slot: usize) -> Constraint {
        let (world, frame) = (Frame::world(Pose::identity()), Frame::of_joint(self.joint(name)));
        Constraint::RelativePose(RelativePose::rigid(world, frame, Reference::Argument(slot)))
    }

    fn masses(&self) -> Masses {
        Masses::of_parts(&self.robot, &[self.robot.part("human").unwrap()]).unwrap()
    }

    /// The centre of mass in the right ankle's frame: where it is when standing, or above a square around there.
    fn balance(&self, square: Option<f64>) -> Constraint {
        let frame = Frame::of_joint(self.joint("r_ankle_roll"));
        let mut balance =
            CentreOfMass { masses: self.masses(), frame, rows: Vec::new(), reference: Reference::Identity };
        let center = centre_of_mass::in_frame(&balance, &self.poses(&self.standing));
        let plane = |normal: DVec3, row, margin| PlaneRow { normal, offset: normal.dot(center) - margin, row };
        balance.rows = match square {
            None => DVec3::AXES.map(|axis| plane(axis, Row::Zero, 0.0)).to_vec(),
            Some(half) => [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y]
                .map(|normal| plane(normal, Row::Inequality, half))
                .to_vec(),
        };
        Constraint::CentreOfMass(balance)
    }

    /// The centre of mass left where its argument says, in two coordinates.
    fn kept(&self, slot: usize) -> Constraint {
        let plane = |normal| PlaneRow { normal, offset: 0.0, row: Row::Parameter };
        let rows = vec![plane(DVec3::X), plane(DVec3::Y)];
        let frame = Frame::of_joint(self.joint("l_ankle_roll"));
        Constraint::CentreOfMass(CentreOfMass {
            masses: self.masses(),
            frame,
            rows,
            reference: Reference::Argument(slot),
        })
    }

    fn between(&self, height: Option<f64>) -> Constraint {
        let [first, second] = ["r_ankle_roll", "l_ankle_roll"].map(|foot| Frame::of_joint(self.joint(foot)));
        Constraint::CentreOfMassBetween(CentreOfMassBetween { masses: self.masses(), first, second, height })
    }

    fn compile(&self, constraints: &[Constraint]) -> ConstraintProgram {
        ConstraintProgram::compile(&self.robot, &self.kinematics, constraints, &[], &[]).unwrap()
    }

    fn near(&mut self, reach: f64) -> Vec<f64> {
        let (mut moved, mut v) = (self.standing.clone(), vec![0.0; self.robot.space.dimension()]);
        v.iter_mut().for_each(|x| *x = self.rng.random_range(-reach..reach));
        self.robot.space.integrate(&self.standing, &v, &mut moved);
        moved
    }

    /// Programs with problems, most of which can be solved.
    fn programs(&mut self) -> Vec<(&'static str, ConstraintProgram, Problems)> {
        let X_WJ = self.poses(&self.standing);
        let [left, right] = ["l_ankle_roll", "r_ankle_roll"].map(|foot| X_WJ[self.joint(foot).at()]);
        let feet = [self.at("l_ankle_roll", 0), self.at("r_ankle_roll", 1)];
        let with = |more: &[Constraint]| self.compile(&[feet.as_slice(), more].concat());
        let [center, apart] = [X_WJ[self.joint("l_ankle_roll").at()], right];
        let middle = 0.5 * (center.translation.z + apart.translation.z);
        let balance = CentreOfMass {
            masses: self.masses(),
            frame: Frame::world(Pose::identity()),
            rows: Vec::new(),
            reference: Reference::Identity,
        };
        let height = centre_of_mass::in_frame(&balance, &X_WJ).z - middle;
        let programs = [
            ("feet", with(&[])),
            ("feet and balance", with(&[self.balance(None)])),
            ("feet, balance and a hand", with(&[self.balance(None), self.at("l_wrist_roll", 2)])),
            ("over a square", with(&[self.balance(Some(0.01))])),
            ("over a small square", with(&[self.balance(Some(1e-4)), self.at("r_wrist_roll", 2)])),
            ("kept", with(&[self.kept(3)])),
            ("between the feet", with(&[self.between(None)])),
            ("between the feet, so high", with(&[self.between(Some(height - 0.02))])),
            ("on one foot", self.compile(&[self.at("l_ankle_roll", 0), self.kept(3)])),
        ];
        let mut found = Vec::new();
        for (name, program) in programs {
            let mut problems = Vec::new();
            for _ in 0..60 {
                let there = self.near(0.1);
                let bodies = self.poses(&there);
                let wrist = if name.contains("small") { "r_wrist_roll" } else { "l_wrist_roll" };
                let Constraint::CentreOfMass(kept) = self.kept(0) else { unreachable!() };
                let center = Pose::from_translation(centre_of_mass::in_frame(&kept, &bodies));
                problems.push((self.near(0.2), vec![left, right, bodies[self.joint(wrist).at()], center]));
            }
            found.push((name, program, problems));
        }
        found
    }
}

fn solve(program: &ConstraintProgram, problems: &Problems, settings: &Settings) -> Solved {
    let mut starts: Vec<Vec<f64>> = problems.iter().map(|(q, _)| q.clone()).collect();
    let mut jobs: Vec<_> = starts.iter_mut().zip(problems).map(|(q, (_, arguments))| Job::new(q, arguments)).collect();
    project_batch(program, &mut jobs, settings, &mut Scratch::default());
    let outcomes: Vec<_> = jobs.iter().map(|job| job.outcome).collect();
    starts.into_iter().zip(outcomes).collect()
}

type Solved = Vec<(Vec<f64>, Outcome)>;

fn count(solved: &Solved) -> usize {
    solved.iter().filter(|(_, outcome)| outcome.is_converged()).count()
}

#[test]
fn what_lanes_find_holds_as_written_and_is_found_as_often() {
    let mut stage = Stage::new(1.0);
    for (name, program, problems) in stage.programs() {
        assert!(program.is_for_lanes(), "{name}");
        let scalar = Settings { level: Level::scalar(), ..Settings::default() };
        let expected = count(&solve(&program, &problems, &scalar));
        assert!(expected > 20, "{name}: {expected} of {}", problems.len());
        for level in Level::available() {
            for single_until in [0.0, 1e-4] {
                let settings = Settings { level, single_until, ..Settings::default() };
                let found = solve(&program, &problems, &settings);
                assert!(count(&found).abs_diff(expected) <= 4, "{name}, {level}: {} of {expected}", count(&found));
                let mut scratch = Scratch::default();
                for ((q, outcome), (_, arguments)) in found.iter().zip(&problems) {
                    let Outcome::Converged { residual, .. } = outcome else { continue };
                    // The root's own rounding too.
                    let deviation = program.deviation(q, arguments, &mut scratch).unwrap();
                    assert!(deviation.rows < residual + 1e-8, "{name}, {level}: {deviation:?} {residual}");
                    assert_eq!(stage.robot.space.first_out_of_bounds(q, 0.0), None, "{name}, {level}");
                }
            }
        }
    }
}

#[test]
fn from_nearby_lanes_and_scalar_code_take_the_same_steps() {
    let mut stage = Stage::new(1.0);
    for (name, program, problems) in stage.programs() {
        let scalar = Settings { level: Level::scalar(), ..Settings::default() };
        let solved = solve(&program, &problems, &scalar);
        let solved = solved.iter().zip(&problems).filter(|((_, outcome), _)| outcome.is_converged());
        let near: Problems = solved
            .map(|((q, _), (other, arguments))| {
                let mut start = q.clone();
                stage.robot.space.interpolate(q, other, 0.05, &mut start);
                (start, arguments.clone())
            })
            .collect();
        for level in Level::available() {
            let found = solve(&program, &near, &Settings { level, ..Settings::default() });
            for ((q, outcome), (start, arguments)) in found.iter().zip(&near) {
                let mut expected = start.clone();
                let scalar = project(&program, &mut expected, arguments, &scalar, &mut Scratch::default());
                let steps = |outcome: &Outcome| match outcome {
                    Outcome::Converged { iterations, .. } => Some(*iterations),
                    _ => None,
                };
                assert_eq!(steps(outcome), steps(&scalar), "{name}, {level}");
                let apart = q.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(apart < 1e-7, "{name}, {level}: {apart}");
            }
        }
    }
}

#[test]
fn a_problem_alone_and_in_a_crowd_ends_in_the_same_bits() {
    let mut stage = Stage::new(1.0);
    for (name, program, problems) in stage.programs() {
        for level in Level::available() {
            let settings = Settings { level, ..Settings::default() };
            let all = solve(&program, &problems, &settings);
            for k in (0..problems.len()).step_by(5) {
                let alone = solve(&program, &problems[k..=k].to_vec(), &settings);
                let bits = |q: &[f64]| q.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&alone[0].0), bits(&all[k].0), "{name}, {level}: {k}");
                assert_eq!(alone[0].1, all[k].1, "{name}, {level}: {k}");
            }
        }
    }
}

#[test]
fn a_root_that_a_foot_puts_out_of_its_bounds_is_refused() {
    let mut stage = Stage::new(0.02);
    let (_, program, problems) = stage.programs().swap_remove(0);
    for level in Level::available() {
        let found = solve(&program, &problems, &Settings { level, ..Settings::default() });
        let refused = found.iter().filter(|(_, outcome)| *outcome == Outcome::RootOutOfBounds).count();
        assert!(refused > 0 && count(&found) > 0, "{level}: {refused}, {}", count(&found));
        for (q, _) in found.iter().filter(|(_, outcome)| outcome.is_converged()) {
            assert_eq!(stage.robot.space.first_out_of_bounds(q, 0.0), None, "{level}");
        }
    }
}

/// A hand that flies and stands on one of its fingers: the way back to the palm slides, and the other finger follows.
#[test]
fn a_slide_is_gone_back_over_too() {
    let palm = PartPlacement {
        root_bounds: vec![(-2.0, 2.0); 3],
        ..models::part("hand", PartKind::Robot, RootJoint::FreeFlyer, Pose::from_rotation(exp_so3(DVec3::X)))
    };
    let robot = Robot::compose(&[(&models::two_finger_hand(), palm)]).unwrap();
    let kinematics = Kinematics::new(&robot);
    let [left, right] = ["hand/left_finger", "hand/right_finger"].map(|j| Frame::of_joint(robot.joint(j).unwrap()));
    let world = Frame::world(Pose::identity());
    let stands = Constraint::RelativePose(RelativePose::rigid(world, left, Reference::Argument(0)));
    let rows = [None, Some(Row::Parameter), None, None, None, None];
    let apart = Constraint::RelativePose(RelativePose { a: left, b: right, rows, reference: Reference::Argument(1) });
    let program = ConstraintProgram::compile(&robot, &kinematics, &[stands, apart], &[], &[]).unwrap();
    assert_eq!((program.equations(), program.is_for_lanes()), ((1, 1), true));
    let place = Pose::from_parts(DVec3::new(0.4, -0.3, 0.2), exp_so3(DVec3::new(0.3, 1.0, -0.4)));
    let problems: Problems = (1..8)
        .map(|k| {
            let gap = Pose::from_translation(DVec3::NEG_Y * 0.01 * f64::from(k));
            (robot.space.neutral(), vec![place, gap])
        })
        .collect();
    for level in Level::available() {
        let found = solve(&program, &problems, &Settings { level, ..Settings::default() });
        for ((q, outcome), (_, arguments)) in found.iter().zip(&problems) {
            assert!(outcome.is_converged(), "{level}: {outcome:?}");
            let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
            kinematics.forward(q, &mut X_WJ);
            let [left, right] = [left, right].map(|frame| X_WJ[frame.joint.unwrap().at()]);
            assert!(left.translation.distance(place.translation) < 1e-9, "{level}");
            let gap = (left.inverse() * right).translation.y;
            assert!((gap - arguments[1].translation.y).abs() < 2e-6, "{level}: {gap}");
        }
    }
}
