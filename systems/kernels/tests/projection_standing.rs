//! A humanoid that stands on a foot: its root goes where the foot and the leg put it, and is no variable of a solve.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

mod heavy_world;

use foliate_components::Pose;
use foliate_components::constraint::{CentreOfMass, Constraint, Frame, Masses, PlaneRow, Reference, RelativePose, Row};
use foliate_components::pose::{exp_so3, log_so3};
use foliate_components::robot::{JointIndex, PartKind, Robot, RootJoint};
use foliate_components::samples::models;
use foliate_kernels::constrained_motion::{
    AttachmentTemplate, ConstraintProgram, MotionEnd, MotionJob, MotionScratch, MotionSettings, Outcome, Scratch,
    Settings, project, project_motion, project_motions,
};
use foliate_kernels::constraints::{centre_of_mass, placement_of, residual};
use foliate_kernels::kinematics::{AttachmentTree, Kinematics, Standing, geometric_jacobian};
use foliate_kernels::lanes::Level;
use glam::DVec3;
use heavy_world::{Draw, bent_knees, flying_human, poses};
use rand::RngExt;

struct Bench {
    robot: Robot,
    kinematics: Kinematics,
    scratch: Scratch,
    draw: Draw,
    /// With bent knees.
    standing: Vec<f64>,
}

impl Bench {
    fn new(seed: u64) -> Self {
        let tilted = Pose::from_parts(DVec3::new(0.3, -0.2, 0.5), exp_so3(DVec3::new(0.4, -0.3, 0.9)));
        let human = flying_human(1.0);
        let block = models::block(DVec3::new(0.1, 0.1, 0.2));
        let rover = models::part("rover", PartKind::Robot, RootJoint::Planar, tilted);
        let robot = Robot::compose(&[
            (&models::humanoid(), human),
            (&block, models::movable_object("box")),
            (&models::two_joint_arm(), rover),
        ])
        .unwrap();
        let kinematics = Kinematics::new(&robot);
        let standing = bent_knees(&robot);
        Self { kinematics, scratch: Scratch::default(), draw: Draw::new(seed), robot, standing }
    }

    fn compile(&self, constraints: &[Constraint]) -> ConstraintProgram {
        ConstraintProgram::compile(&self.robot, &self.kinematics, constraints, &[], &[]).unwrap()
    }

    fn joint(&self, name: &str) -> JointIndex {
        self.robot.joint(name).unwrap()
    }

    /// Six rows that put a body's frame where an argument says.
    fn at(&self, name: &str, slot: usize) -> Constraint {
        let (world, frame) = (Frame::world(Pose::identity()), Frame::of_joint(self.joint(name)));
        Constraint::RelativePose(RelativePose::rigid(world, frame, Reference::Argument(slot)))
    }

    fn pose(&self, name: &str, q: &[f64]) -> Pose {
        poses(&self.kinematics, &[], q)[self.joint(name).at()]
    }

    /// The centre of mass where it is when standing, in the right ankle's frame.
    fn balance(&self) -> Constraint {
        let plane = |normal| PlaneRow { normal, offset: 0.0, row: Row::Zero };
        let masses = Masses::of_parts(&self.robot, &[self.robot.part("human").unwrap()]).unwrap();
        let frame = Frame::of_joint(self.joint("human/r_ankle_roll"));
        let rows = DVec3::AXES.map(plane).to_vec();
        let mut balance = CentreOfMass { masses, frame, rows, reference: Reference::Identity };
        let center = centre_of_mass::in_frame(&balance, &poses(&self.kinematics, &[], &self.standing));
        balance.rows.iter_mut().for_each(|plane| plane.offset = plane.normal.dot(center));
        Constraint::CentreOfMass(balance)
    }

    fn project(&mut self, program: &ConstraintProgram, q: &mut [f64], arguments: &[Pose]) -> Outcome {
        project(program, q, arguments, &Settings::default(), &mut self.scratch)
    }

    fn near(&mut self, reach: f64) -> Vec<f64> {
        let (mut moved, mut v) = (self.standing.clone(), vec![0.0; self.robot.space.dimension()]);
        v.iter_mut().for_each(|x| *x = self.draw.rng.random_range(-reach..reach));
        self.robot.space.integrate(&self.standing, &v, &mut moved);
        moved
    }

    fn feet(&self) -> [Pose; 2] {
        ["human/l_ankle_roll", "human/r_ankle_roll"].map(|foot| self.pose(foot, &self.standing))
    }
}

/// Two feet, balance and a hand: the program says what it said, the solve leaves out the root and one foot, and what it
/// finds holds as written, from the root outwards.
#[test]
fn both_feet_balance_and_a_hand_hold_as_written() {
    let mut bench = Bench::new(1);
    let [left, right] = bench.feet();
    let feet = [bench.at("human/l_ankle_roll", 0), bench.at("human/r_ankle_roll", 1), bench.balance()];
    let constraints = [feet.as_slice(), &[bench.at("human/l_wrist_roll", 2)]].concat();
    let (stance, reach) = (bench.compile(&feet), bench.compile(&constraints));
    assert_eq!((reach.active().len(), reach.rows()), (33, 21));
    assert_eq!(reach.equations(), (27, 15));
    let mut solved = 0;
    for _ in 0..60 {
        let mut there = bench.near(0.2);
        if !bench.project(&stance, &mut there, &[left, right]).is_converged() {
            continue;
        }
        let arguments = [left, right, bench.pose("human/l_wrist_roll", &there)];
        let mut q = bench.near(0.2);
        if !bench.project(&reach, &mut q, &arguments).is_converged() {
            continue;
        }
        solved += 1;
        let bodies = poses(&bench.kinematics, &[], &q);
        for (constraint, slot) in constraints.iter().zip([Some(0), Some(1), None, Some(2)]) {
            let written = match constraint {
                Constraint::RelativePose(pose) => {
                    let reference = slot.map_or(pose.reference, |slot| Reference::Fixed(arguments[slot]));
                    Constraint::RelativePose(RelativePose { reference, ..*pose })
                }
                other => other.clone(),
            };
            assert!(residual(&bench.robot, &written, &q, &bodies) < 2e-6, "{constraint:?}");
        }
        assert_eq!(bench.robot.space.first_out_of_bounds(&q, 0.0), None);
        let deviation = reach.deviation(&q, &arguments, &mut bench.scratch).unwrap();
        assert!(deviation.rows < 2e-6 && deviation.objects == 0.0, "{deviation:?}");
        // A root that is elsewhere is noticed.
        q[0] += 1e-3;
        assert!(reach.residual(&q, &arguments, &mut bench.scratch).unwrap() > 0.5e-3);
    }
    assert!(solved > 30, "{solved}");
}

/// The foot itself is exact, whatever the argument: it is put there, not solved for.
#[test]
fn the_root_goes_where_the_foot_puts_it() {
    let mut bench = Bench::new(2);
    for reversed in [false, true] {
        let (world, foot) = (Frame::world(Pose::from_translation(DVec3::X)), bench.joint("human/l_ankle_roll"));
        let foot = Frame::of_joint(foot).then(&Pose::from_translation(DVec3::NEG_Z * 0.05));
        let (a, b) = if reversed { (foot, world) } else { (world, foot) };
        let program = bench.compile(&[Constraint::RelativePose(RelativePose::rigid(a, b, Reference::Argument(0)))]);
        assert_eq!((program.rows(), program.equations()), (6, (0, 0)));
        for _ in 0..50 {
            let turn = bench.draw.vector(0.5);
            let mut q = bench.near(0.3);
            let X_AB = Pose::from_parts(bench.draw.vector(0.1), exp_so3(turn));
            let start = q.clone();
            let outcome = bench.project(&program, &mut q, &[X_AB]);
            if outcome == Outcome::RootOutOfBounds {
                assert!(bench.robot.space.first_out_of_bounds(&q, 0.0).is_some());
                continue;
            }
            assert!(matches!(outcome, Outcome::Converged { iterations: 0, .. }), "{outcome:?}");
            let bodies = poses(&bench.kinematics, &[], &q);
            let found = placement_of(&a).in_world(&bodies).inverse() * placement_of(&b).in_world(&bodies);
            assert!(found.translation.distance(X_AB.translation) < 1e-12);
            assert!(log_so3(X_AB.rotation.conjugate() * found.rotation).length() < 1e-12);
            // Nothing but the root has moved, and its quaternion has kept its sign.
            assert_eq!(q[7..], start[7..]);
            assert!((3..7).map(|k| q[k] * start[k]).sum::<f64>() >= 0.0);
        }
    }
}

#[test]
fn a_root_out_of_its_bounds_is_no_solution() {
    let mut bench = Bench::new(3);
    let program = bench.compile(&[bench.at("human/l_ankle_roll", 0)]);
    let far = Pose::from_translation(DVec3::new(5.0, 0.0, 0.0));
    let mut q = bench.standing.clone();
    assert_eq!(bench.project(&program, &mut q, &[far]), Outcome::RootOutOfBounds);
}

/// What moves the other foot, a hand, an object in the world or the robot's own root against the world: numerically, with
/// the foot held where it is.
#[test]
fn joints_move_what_stands_as_finite_differences_say() {
    let mut bench = Bench::new(4);
    let robot = bench.robot.clone();
    let [root, foot] = ["human/root_joint", "human/l_ankle_roll"].map(|name| bench.joint(name));
    let mut tree = AttachmentTree::new(&robot);
    assert_eq!(tree.stand_on(foot), Some(root));
    assert_eq!((tree.standing(), tree.stand_on(foot)), (Some(Standing { root, foot }), None));
    let standing = |q: &[f64], X_WF: Pose| {
        let mut q = q.to_vec();
        let bodies = poses(&bench.kinematics, &[], &q);
        let X_WR = X_WF * bodies[foot.at()].inverse() * bodies[root.at()];
        let X_JR = robot.joints[root.at()].parent_from_joint.inverse() * X_WR;
        let (t, r) = (X_JR.translation, X_JR.rotation);
        q[..7].copy_from_slice(&[t.x, t.y, t.z, r.x, r.y, r.z, r.w]);
        poses(&bench.kinematics, &[], &q)
    };
    let dimension = robot.space.dimension();
    for _ in 0..5 {
        let mut q = robot.space.neutral();
        robot.space.random(&mut bench.draw.rng, &mut q);
        let X_WF = poses(&bench.kinematics, &[], &q)[foot.at()];
        let bodies = standing(&q, X_WF);
        for name in ["human/r_ankle_roll", "human/l_knee", "human/l_wrist_roll", "human/root_joint"] {
            let body = bench.joint(name);
            let columns = tree.columns(None, Some(body), Some);
            assert!(columns.iter().all(|column| column.variable() >= 6), "the root is no variable");
            let mut jacobian = vec![0.0; 6 * dimension];
            geometric_jacobian(&columns, &bodies, bodies[body.at()].translation, &mut jacobian);
            for v in 6..dimension {
                let (mut ahead, mut behind, mut step) = (q.clone(), q.clone(), vec![0.0; dimension]);
                let h = 1e-6;
                step[v] = h;
                robot.space.integrate(&q, &step, &mut ahead);
                step[v] = -h;
                robot.space.integrate(&q, &step, &mut behind);
                let [a, b] = [&ahead, &behind].map(|q| standing(q, X_WF)[body.at()]);
                let linear = (a.translation - b.translation) / (2.0 * h);
                let angular = log_so3(a.rotation * b.rotation.conjugate()) / (2.0 * h);
                let column = &jacobian[6 * v..][..6];
                assert!(linear.distance(DVec3::from_slice(column)) < 1e-6, "{name} {v}");
                assert!(angular.distance(DVec3::from_slice(&column[3..])) < 1e-6, "{name} {v}");
            }
        }
        // What is fixed in the world moves against the robot, and with it what lies in the world.
        let object = bench.joint("box/root_joint");
        let (to_world, back) = (tree.columns(Some(root), None, Some), tree.columns(None, Some(root), Some));
        assert_eq!(to_world.len(), back.len());
        assert_eq!(tree.columns(Some(root), Some(object), Some).len(), to_world.len() + 6);
    }
}

/// A box in the hand follows the hand of the robot that stands; a box on the ground stays.
#[test]
fn carried_objects_follow() {
    let mut bench = Bench::new(5);
    let [left, right] = bench.feet();
    let [object, hand] = ["box/root_joint", "human/r_wrist_roll"].map(|name| bench.joint(name));
    let X_CO = Pose::from_translation(DVec3::new(0.0, 0.0, -0.2));
    let feet = [bench.at("human/l_ankle_roll", 0), bench.at("human/r_ankle_roll", 1)];
    for carrier in [Some(hand), None] {
        let carried = AttachmentTemplate::fixed(object, carrier, X_CO);
        let program = ConstraintProgram::compile(&bench.robot, &bench.kinematics, &feet, &[carried], &[]).unwrap();
        assert_eq!(program.rigid_attachments().len(), 1, "the foot carries nothing that anybody sees");
        let mut q = bench.near(0.1);
        assert!(bench.project(&program, &mut q, &[left, right]).is_converged());
        let bodies = poses(&bench.kinematics, &[], &q);
        let there = carrier.map_or(X_CO, |hand| bodies[hand.at()] * X_CO);
        assert!(bodies[object.at()].translation.distance(there.translation) < 1e-12);
    }
}

/// A motion is that of the root as written: between the knots both feet stay, the one that stands too.
#[test]
fn a_motion_on_both_feet_keeps_them_between_the_knots() {
    let mut bench = Bench::new(6);
    let [left, right] = bench.feet();
    let one = [bench.at("human/l_ankle_roll", 0)];
    let both = [bench.at("human/l_ankle_roll", 0), bench.at("human/r_ankle_roll", 1), bench.balance()];
    let settings = MotionSettings::default();
    let mut scratch = MotionScratch::default();
    for constraints in [one.as_slice(), &both] {
        let program = bench.compile(constraints);
        let (mut reached, mut used, mut longest) = (0, 0, 0.0_f64);
        let feet = constraints.len().min(2);
        for _ in 0..20 {
            let (mut from, mut to) = (bench.near(0.2), bench.near(0.2));
            let ends = [&mut from, &mut to].map(|q| bench.project(&program, q, &[left, right]).is_converged());
            if ends != [true, true] {
                continue;
            }
            let mut knots = Vec::new();
            let space = &bench.robot.space;
            let ends = (from.as_slice(), to.as_slice());
            let end = project_motion(&program, space, ends, &[left, right], &settings, &mut scratch, &mut knots);
            reached += u32::from(end == MotionEnd::Reached);
            let knots: Vec<_> = knots.chunks(space.size()).collect();
            assert!(knots.len() > 2, "a root that moves straight takes the foot along");
            used += knots.len();
            let mut q = space.neutral();
            for pair in knots.windows(2) {
                for sample in 0..=16 {
                    space.interpolate(pair[0], pair[1], f64::from(sample) / 16.0, &mut q);
                    let residual = program.residual(&q, &[left, right], &mut bench.scratch).unwrap();
                    assert!(residual <= settings.path_tolerance, "{residual}");
                    // What is claimed of a motion is the length of what is one vector, not its largest row.
                    let bodies = poses(&bench.kinematics, &[], &q);
                    for (foot, there) in
                        ["human/l_ankle_roll", "human/r_ankle_roll"].iter().zip([left, right]).take(feet)
                    {
                        let here = bodies[bench.joint(foot).at()];
                        let apart = here.translation.distance(there.translation);
                        let turned = log_so3(there.rotation.conjugate() * here.rotation).length();
                        longest = longest.max(apart).max(turned);
                    }
                }
            }
        }
        println!("{reached} of 20 motions arrive, {used} knots in all, feet move {longest:.2e}");
        assert!(longest <= settings.path_tolerance, "{longest}");
        assert!(reached > 10, "{reached}");
    }
}

/// Nothing changes for what has no free root, whose foot is not held in all directions, or who holds on to what moves.
#[test]
fn what_does_not_stand_keeps_its_root() {
    let bench = Bench::new(7);
    let world = Frame::world(Pose::identity());
    let [ankle, wrist] = ["human/l_ankle_roll", "human/l_wrist_roll"].map(|name| Frame::of_joint(bench.joint(name)));
    let [wheel, object] = ["rover/elbow", "box/root_joint"].map(|name| bench.robot.joint(name).map(Frame::of_joint));
    let rigid = |a, b| RelativePose::rigid(a, b, Reference::Identity);
    let flat = RelativePose {
        rows: [None, None, Some(Row::Zero), Some(Row::Zero), Some(Row::Zero), None],
        ..rigid(world, ankle)
    };
    let mut others = vec![flat, rigid(ankle, wrist)];
    others.extend(wheel.map(|wheel| rigid(world, wheel)));
    others.extend(object.map(|object| rigid(world, object)));
    for pose in others {
        let program = bench.compile(&[Constraint::RelativePose(pose)]);
        assert_eq!(program.equations(), (program.active().len(), program.rows()), "{pose:?}");
    }
}

/// Several humanoids at once, one per lane: each motion is what it is alone, and keeps feet and balance between its knots.
#[test]
fn motions_on_both_feet_are_walked_side_by_side() {
    let mut bench = Bench::new(7);
    let feet = bench.feet();
    let both = [bench.at("human/l_ankle_roll", 0), bench.at("human/r_ankle_roll", 1), bench.balance()];
    let program = bench.compile(&both);
    assert!(program.is_for_lanes());
    let mut wanted = Vec::new();
    while wanted.len() < 11 {
        let (mut from, mut to) = (bench.near(0.15), bench.near(0.15));
        if [&mut from, &mut to].map(|q| bench.project(&program, q, &feet).is_converged()) == [true, true] {
            wanted.push((from, to));
        }
    }
    let space = &bench.robot.space;
    for level in Level::available() {
        let solve = Settings { level, ..Settings::default() };
        let settings = MotionSettings { solve, ..MotionSettings::default() };
        let walk = |wanted: &[(Vec<f64>, Vec<f64>)]| {
            let mut knots = vec![Vec::new(); wanted.len()];
            let mut jobs: Vec<_> = wanted
                .iter()
                .zip(&mut knots)
                .map(|((from, to), knots)| MotionJob::new((from, to), &feet, knots))
                .collect();
            project_motions(&program, space, &mut jobs, &settings, &mut MotionScratch::default());
            let ends: Vec<_> = jobs.iter().map(|job| job.end).collect();
            ends.into_iter().zip(knots).collect::<Vec<_>>()
        };
        let all = walk(&wanted);
        let arrived = all.iter().filter(|(end, _)| *end == MotionEnd::Reached).count();
        assert!(arrived >= 6, "{level}: {arrived}");
        let mut q = space.neutral();
        for (k, (end, knots)) in all.iter().enumerate() {
            let alone = &walk(&wanted[k..=k])[0];
            assert_eq!(*end, alone.0, "{level}: a crowd matters to {k}");
            assert!(knots.iter().zip(&alone.1).all(|(a, b)| a.to_bits() == b.to_bits()), "{level}: {k}");
            let knots: Vec<_> = knots.chunks(space.size()).collect();
            for pair in knots.windows(2) {
                for sample in 0..=9 {
                    space.interpolate(pair[0], pair[1], f64::from(sample) / 9.0, &mut q);
                    let residual = program.residual(&q, &feet, &mut bench.scratch).unwrap();
                    assert!(residual <= settings.path_tolerance, "{level}: {residual}");
                }
            }
        }
    }
}
