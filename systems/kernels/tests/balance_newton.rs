//! A humanoid keeps its balance: projection onto feet, centre of mass and hand, with what it carries; half-spaces speak
//! only where they are violated; objects on objects follow in whatever order they are named.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

mod heavy_world;

use foliate_components::Pose;
use foliate_components::constraint::{
    CentreOfMass, CentreOfMassBetween, Constraint, Custom, Distance, Frame, Locked, LockedValue, Masses, PlaneRow,
    Reference, Region, RelativePose, Row, Tilt,
};
use foliate_components::robot::model::Inertial;
use foliate_components::robot::{PartIndex, PartKind, PartPlacement, Robot, RootJoint};
use foliate_components::samples::models;
use foliate_kernels::constrained_motion::{
    AttachmentTemplate, CompileError, ConstraintProgram, MotionEnd, MotionScratch, MotionSettings, Outcome, Scratch,
    Settings, project, project_motion,
};
use foliate_kernels::constraints::{centre_of_mass, parameter, placement_of, residual};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use glam::DVec3;
use heavy_world::{Draw, Gaze, held, poses, world};
use std::sync::Arc;

/// A humanoid, and a box of 5 kg.
struct Bench {
    robot: Robot,
    kinematics: Kinematics,
    scratch: Scratch,
    draw: Draw,
    /// Standing with bent knees.
    standing: Vec<f64>,
}

impl Bench {
    fn new(seed: u64) -> Self {
        let mut block = models::block(DVec3::new(0.2, 0.2, 0.3));
        block.links[0].inertial = Some(Inertial { mass: 5.0, center: DVec3::new(0.0, 0.05, 0.0) });
        let human = PartPlacement {
            root_bounds: vec![(-1.0, 1.0); 3],
            ..models::part("human", PartKind::Robot, RootJoint::FreeFlyer, Pose::identity())
        };
        let robot = Robot::compose(&[(&models::humanoid(), human), (&block, models::movable_object("box"))]).unwrap();
        let mut standing = robot.space.neutral();
        let set = |q: &mut [f64], joint: &str, value: f64| q[coordinate(&robot, joint)] = value;
        for side in ["l", "r"] {
            for (joint, value) in
                [("hip_pitch", -0.4), ("knee", 0.8), ("ankle_pitch", -0.4), ("shoulder_pitch", -0.4), ("elbow", -1.0)]
            {
                set(&mut standing, &format!("human/{side}_{joint}"), value);
            }
        }
        Self {
            kinematics: Kinematics::new(&robot),
            scratch: Scratch::default(),
            draw: Draw::new(seed),
            robot,
            standing,
        }
    }

    fn compile(&self, constraints: &[Constraint]) -> ConstraintProgram {
        ConstraintProgram::compile(&self.robot, &self.kinematics, constraints, &[], &[]).unwrap()
    }

    fn poses(&self, q: &[f64]) -> Vec<Pose> {
        poses(&self.kinematics, &[], q)
    }

    fn frame(&self, joint: &str) -> Frame {
        Frame::of_joint(self.robot.joint(joint).unwrap())
    }

    fn masses(&self, parts: &[&str]) -> Masses {
        let parts: Vec<PartIndex> = parts.iter().map(|part| self.robot.part(part).unwrap()).collect();
        Masses::of_parts(&self.robot, &parts).unwrap()
    }

    /// Both feet where they stand.
    fn feet(&self) -> [Constraint; 2] {
        let bodies = self.poses(&self.standing);
        ["human/l_ankle_roll", "human/r_ankle_roll"].map(|joint| {
            let foot = self.frame(joint);
            let there = Reference::Fixed(bodies[foot.joint.unwrap().at()]);
            Constraint::RelativePose(RelativePose::rigid(Frame::world(Pose::identity()), foot, there))
        })
    }

    /// The centre of mass where it is when standing, in the left ankle's frame; all rows alike.
    fn balance(&self, parts: &[&str], row: Row) -> CentreOfMass {
        let rows = DVec3::AXES.map(|normal| PlaneRow { normal, offset: 0.0, row }).to_vec();
        let (masses, frame) = (self.masses(parts), self.frame("human/l_ankle_roll"));
        let mut balance = CentreOfMass { masses, frame, rows, reference: Reference::Identity };
        let center = centre_of_mass::in_frame(&balance, &self.poses(&self.standing));
        balance.rows.iter_mut().for_each(|plane| plane.offset = plane.normal.dot(center));
        balance
    }

    fn hand_at(&self, slot: usize) -> Constraint {
        let hand = self.robot.gripper("human/l_hand").unwrap();
        let hand = &self.robot.grippers[hand.at()];
        let frame = Frame::on_link(&self.robot, hand.link, &hand.link_from_gripper);
        let world = Frame::world(Pose::identity());
        Constraint::RelativePose(RelativePose::rigid(world, frame, Reference::Argument(slot)))
    }

    fn project(&mut self, program: &ConstraintProgram, q: &mut [f64], arguments: &[Pose]) -> Outcome {
        project(program, q, arguments, &Settings::default(), &mut self.scratch)
    }

    /// A configuration near another one.
    fn near(&mut self, q: &[f64], reach: f64) -> Vec<f64> {
        use rand::RngExt;
        let (mut moved, mut v) = (q.to_vec(), vec![0.0; self.robot.space.dimension()]);
        v.iter_mut().for_each(|x| *x = self.draw.rng.random_range(-reach..reach));
        self.robot.space.integrate(q, &v, &mut moved);
        moved
    }
}

fn coordinate(robot: &Robot, joint: &str) -> usize {
    match robot.joints[robot.joint(joint).unwrap().at()].source {
        foliate_components::robot::Source::Coordinates { q, .. } => q,
        foliate_components::robot::Source::Follows { leader, .. } => unreachable!("{joint} follows {leader:?}"),
    }
}

#[test]
fn a_humanoid_reaches_on_two_feet_in_balance() {
    let mut bench = Bench::new(1);
    let balance = Constraint::CentreOfMass(bench.balance(&["human"], Row::Zero));
    let [left, right] = bench.feet();
    let constraints = [left, right, balance, bench.hand_at(0)];
    let program = bench.compile(&constraints);
    // The right arm moves the centre of mass too, the box moves nothing.
    assert_eq!((program.active().len(), program.rows()), (33, 21));
    let (mut near, mut far) = (0, 0);
    for round in 0..100 {
        // A place that can be reached: where the hand is in some configuration in balance.
        let mut there = bench.near(&bench.standing.clone(), 0.3);
        let free = bench.compile(&constraints[..3]);
        if !bench.project(&free, &mut there, &[]).is_converged() {
            continue;
        }
        let bodies = bench.poses(&there);
        let Constraint::RelativePose(hand) = &constraints[3] else { unreachable!() };
        let target = [placement_of(&hand.b).in_world(&bodies)];
        let warm = round % 2 == 0;
        let mut q = if warm { bench.near(&there, 0.05) } else { bench.draw.configuration(&bench.robot.clone()) };
        let converged = bench.project(&program, &mut q, &target).is_converged();
        if !converged {
            continue;
        }
        let bodies = bench.poses(&q);
        for constraint in &constraints[..3] {
            assert!(residual(&bench.robot, constraint, &q, &bodies) < 2e-6);
        }
        assert!(placement_of(&hand.b).in_world(&bodies).translation.distance(target[0].translation) < 2e-6);
        assert_eq!(bench.robot.space.first_out_of_bounds(&q, 0.0), None);
        if warm { near += 1 } else { far += 1 }
    }
    println!("of about 50 each: {near} warm starts and {far} random ones converge");
    assert!(near >= 45, "{near}");
    assert!(far >= 5, "{far}");
}

/// The weight of a box in the hand counts where the hand takes it.
#[test]
fn the_balance_of_robot_and_box_follows_the_hand() {
    let mut bench = Bench::new(2);
    let both = bench.balance(&["human", "box"], Row::Zero);
    let alone = bench.balance(&["human"], Row::Zero);
    let [left, right] = bench.feet();
    let hand = bench.frame("human/l_wrist_roll");
    let X_CO = Pose::from_translation(DVec3::new(0.0, 0.0, -0.25));
    let object = bench.robot.joint("box/root_joint").unwrap();
    let rigid_attachment = AttachmentTemplate::fixed(object, hand.joint, X_CO);
    // Where the robot and the box in its hand balance as the robot alone did.
    let wanted = CentreOfMass { masses: both.masses.clone(), ..alone.clone() };
    let constraints = [left, right, Constraint::CentreOfMass(wanted.clone())];
    let compile = |rigid_attachments: &[AttachmentTemplate]| {
        ConstraintProgram::compile(&bench.robot, &bench.kinematics, &constraints, rigid_attachments, &[]).unwrap()
    };
    let (carried, loose) = (compile(&[rigid_attachment]), compile(&[]));
    assert_eq!((carried.active().len(), carried.rows()), (33, 15));
    assert_eq!(loose.active().len(), 39, "a loose box balances the robot by flying");
    let mut q = bench.standing.clone();
    assert!(bench.project(&carried, &mut q, &[]).is_converged());
    let bodies = bench.poses(&q);
    let held = bodies[hand.joint.unwrap().at()] * X_CO;
    assert!(bodies[object.at()].translation.distance(held.translation) < 1e-9, "the box is in the hand");
    let center = centre_of_mass::in_frame(&wanted, &bodies);
    let expected = centre_of_mass::in_frame(&alone, &bench.poses(&bench.standing));
    assert!(center.distance(expected) < 2e-6);
    // The robot leans away from it.
    let robot_alone = centre_of_mass::in_frame(&alone, &bodies);
    let pulled = 5.0 / 58.0
        * (center
            - placement_of(&alone.frame)
                .in_world(&bodies)
                .inverse_transform_point(bodies[object.at()].transform_point(DVec3::new(0.0, 0.05, 0.0))));
    assert!((robot_alone - center).distance(pulled) < 1e-9 && pulled.length() > 0.01, "{pulled}");
}

#[test]
fn a_frozen_centre_of_mass_is_a_leaf() {
    let mut bench = Bench::new(3);
    let mut balance = bench.balance(&["human"], Row::Parameter);
    balance.rows.iter_mut().for_each(|plane| plane.offset = 0.0);
    let [left, right] = bench.feet();
    let constraint = Constraint::CentreOfMass(balance);
    assert!(constraint.foliates() && constraint.without_parameters().is_none());
    let program = bench.compile(&[left, right, constraint.at_slot(0)]);
    assert_eq!(program.arguments(), 1);
    for _ in 0..10 {
        let start = bench.near(&bench.standing.clone(), 0.1);
        let argument = parameter(&bench.robot, &constraint, &start, &bench.poses(&start));
        let mut q = bench.standing.clone();
        if !bench.project(&program, &mut q, &[argument]).is_converged() {
            continue;
        }
        let again = parameter(&bench.robot, &constraint, &q, &bench.poses(&q));
        assert!(again.translation.distance(argument.translation) < 2e-6);
        assert_eq!(residual(&bench.robot, &constraint, &q, &bench.poses(&q)), 0.0, "parameter rows do not count");
    }
    assert_eq!(bench.project(&program, &mut bench.standing.clone(), &[]), Outcome::Malformed);
}

/// A support polygon: outside, projection brings the centre of mass back to its edge; inside, nothing is asked.
#[test]
fn half_spaces_speak_only_where_they_are_violated() {
    let mut bench = Bench::new(4);
    let mut balance = bench.balance(&["human"], Row::Inequality);
    let center = centre_of_mass::in_frame(&balance, &bench.poses(&bench.standing));
    // A square of 6 cm around where it stands.
    let edge = |normal: DVec3| PlaneRow { normal, offset: normal.dot(center) - 0.03, row: Row::Inequality };
    balance.rows = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y].map(edge).to_vec();
    let constraint = Constraint::CentreOfMass(balance.clone());
    let [left, right] = bench.feet();
    let program = bench.compile(&[left, right, constraint.clone()]);
    let (mut inside, mut outside) = (0, 0);
    for round in 0..60 {
        // The left foot stays where it is, so a leg that bends leans the body: a few degrees leave the square.
        let reach = if round % 2 == 0 { 0.02 } else { 0.3 };
        let mut q = bench.near(&bench.standing.clone(), reach);
        let before = residual(&bench.robot, &constraint, &q, &bench.poses(&q));
        let feet = bench.compile(&bench.feet());
        let mut feet_only = q.clone();
        if !bench.project(&feet, &mut feet_only, &[]).is_converged() {
            continue;
        }
        let drawn = residual(&bench.robot, &constraint, &feet_only, &bench.poses(&feet_only));
        let satisfied = drawn == 0.0;
        if satisfied {
            let mut same = feet_only.clone();
            let outcome = bench.project(&program, &mut same, &[]);
            assert!(matches!(outcome, Outcome::Converged { iterations: 0, .. }), "{outcome:?}");
            assert_eq!(same, feet_only);
            inside += 1;
            continue;
        }
        if !bench.project(&program, &mut q, &[]).is_converged() {
            continue;
        }
        let after = residual(&bench.robot, &constraint, &q, &bench.poses(&q));
        assert!(after <= 1e-6, "{before} {after}");
        outside += 1;
    }
    assert!(inside > 5 && outside > 5, "{inside} {outside}");
}

#[test]
fn balance_over_the_line_between_two_feet() {
    let mut bench = Bench::new(5);
    let [first, second] = ["human/l_ankle_roll", "human/r_ankle_roll"].map(|joint| bench.frame(joint));
    let masses = bench.masses(&["human"]);
    let constraint = Constraint::CentreOfMassBetween(CentreOfMassBetween { masses, first, second, height: Some(0.7) });
    let program = bench.compile(std::slice::from_ref(&constraint));
    assert_eq!(program.rows(), 4);
    let mut solved = 0;
    for _ in 0..40 {
        let mut q = bench.near(&bench.standing.clone(), 0.5);
        if !bench.project(&program, &mut q, &[]).is_converged() {
            continue;
        }
        let bodies = bench.poses(&q);
        let Constraint::CentreOfMassBetween(balance) = &constraint else { unreachable!() };
        let center = centre_of_mass::centre(&balance.masses, &bodies);
        let [a, b] = [first, second].map(|foot| bodies[foot.joint.unwrap().at()].translation);
        assert!((center.z - 0.5 * (a.z + b.z) - 0.7).abs() < 2e-6);
        let (along, from) = ((b - a).truncate(), (center - a).truncate());
        let share = from.dot(along) / along.length_squared();
        assert!((-1e-5..=1.0 + 1e-5).contains(&share), "{share}");
        assert!((from - along * share).length() < 2e-6);
        solved += 1;
    }
    assert!(solved > 20, "{solved}");
}

#[test]
fn points_keep_their_distance() {
    let mut bench = Bench::new(6);
    let [a, b] = ["human/l_wrist_roll", "human/r_wrist_roll"].map(|joint| bench.frame(joint));
    let settled = |bench: &mut Bench, row, at_most, length: f64| {
        let apart = Distance { a, b, length, row, at_most };
        let program = bench.compile(&[Constraint::Distance(apart)]);
        assert_eq!((program.active().len(), program.rows()), (14, 1), "from hand to hand");
        let mut q = bench.standing.clone();
        let outcome = bench.project(&program, &mut q, &[]);
        assert!(outcome.is_converged(), "{outcome:?}");
        let bodies = bench.poses(&q);
        bodies[a.joint.unwrap().at()].translation.distance(bodies[b.joint.unwrap().at()].translation)
    };
    let standing = settled(&mut bench, Row::Inequality, false, 0.1);
    assert!((standing - 0.4).abs() < 0.01, "{standing}: the shoulders' width");
    for (row, at_most, length, expected) in [
        (Row::Zero, false, 0.6, 0.6),
        (Row::Zero, true, 0.3, 0.3),
        (Row::Inequality, false, 0.6, 0.6),
        (Row::Inequality, true, 0.6, standing),
        (Row::Inequality, true, 0.2, 0.2),
    ] {
        let apart = settled(&mut bench, row, at_most, length);
        assert!((apart - expected).abs() < 2e-6, "{row:?} {at_most} {length}: {apart}");
    }
}

/// A whole motion in balance: its knots are near enough that it stays so between them.
#[test]
fn a_motion_keeps_its_balance_between_the_knots() {
    let mut bench = Bench::new(7);
    let [left, right] = bench.feet();
    let balance = Constraint::CentreOfMass(bench.balance(&["human"], Row::Zero));
    let constraints = [left, right, balance];
    let program = bench.compile(&constraints);
    let mut to = bench.near(&bench.standing.clone(), 0.2);
    let mut from = bench.standing.clone();
    assert!(bench.project(&program, &mut from, &[]).is_converged());
    assert!(bench.project(&program, &mut to, &[]).is_converged());
    let settings = MotionSettings::default();
    let (mut scratch, mut knots) = (MotionScratch::default(), Vec::new());
    let end = project_motion(&program, &bench.robot.space, (&from, &to), &[], &settings, &mut scratch, &mut knots);
    assert_eq!(end, MotionEnd::Reached);
    let size = bench.robot.space.size();
    let knots: Vec<_> = knots.chunks(size).collect();
    let (mut q, mut worst) = (bench.standing.clone(), 0.0_f64);
    for pair in knots.windows(2) {
        for sample in 0..=10 {
            bench.robot.space.interpolate(pair[0], pair[1], f64::from(sample) / 10.0, &mut q);
            let bodies = bench.poses(&q);
            worst = constraints.iter().map(|c| residual(&bench.robot, c, &q, &bodies)).fold(worst, f64::max);
        }
    }
    println!("{} knots, largest residual {worst:.1e} of {:.1e}", knots.len(), settings.path_tolerance);
    assert!(worst <= settings.path_tolerance);
}

/// What a constraint says on its own is what a program with nothing else says.
#[test]
fn one_constraint_alone_is_as_far_as_its_program_says() {
    let robot = world();
    let kinematics = Kinematics::new(&robot);
    let (mut draw, mut scratch) = (Draw::new(8), Scratch::default());
    for round in 0..200 {
        let balance = draw.balance(&robot, [Row::Zero, Row::Inequality, Row::Inequality]);
        let joint = robot.joint("arm/e0").unwrap();
        let poses_of = |draw: &mut Draw, rows| {
            let reference = if round % 2 == 0 { Reference::Identity } else { Reference::Fixed(Pose::IDENTITY) };
            RelativePose { a: draw.frame(&robot), b: draw.frame(&robot), rows, reference }
        };
        let (zero, least) = (Some(Row::Zero), Some(Row::Inequality));
        let (a, b) = (draw.frame(&robot), draw.frame(&robot));
        let constraint = match round % 8 {
            0 => Constraint::CentreOfMass(CentreOfMass { reference: Reference::Identity, ..balance }),
            1 => Constraint::CentreOfMassBetween(draw.between(&robot, Some(0.3))),
            2 => Constraint::Distance(draw.distance(&robot, Row::Inequality, true)),
            3 => Constraint::Custom(draw.gaze(&robot)),
            5 => Constraint::Tilt(Tilt { a, b, within: 0.3 }),
            6 => Constraint::Region(Region { a, b, bounds: [(0.1, 0.2), (-0.3, f64::INFINITY), (0.0, 0.4)] }),
            4 => Constraint::RelativePose(poses_of(&mut draw, [zero, least, None, zero, zero, None])),
            _ => Constraint::Locked(Locked { joint, value: LockedValue::Fixed(0.2) }),
        };
        let q = draw.configuration(&robot);
        let program =
            ConstraintProgram::compile(&robot, &kinematics, std::slice::from_ref(&constraint), &[], &[]).unwrap();
        let alone = residual(&robot, &constraint, &q, &poses(&kinematics, &[], &q));
        let expected = program.deviation(&q, &[], &mut scratch).unwrap().rows;
        assert!((alone - expected).abs() < 1e-12, "{constraint:?}: {alone} {expected}");
    }
}

/// The parameter of any kind, read where the bodies are, puts them on the leaf; rows that are zero stay zero at it.
#[test]
fn parameters_of_relative_poses_and_joints_reproduce_the_place() {
    let robot = world();
    let kinematics = Kinematics::new(&robot);
    let (mut draw, mut scratch) = (Draw::new(9), Scratch::default());
    let fixed = Pose::from_parts(DVec3::new(0.1, 0.2, 0.3), foliate_components::pose::exp_so3(DVec3::X * 0.4));
    for round in 0..60 {
        let (free, kept) = (None, Some(Row::Parameter));
        let (a, b) = (draw.frame(&robot), draw.frame(&robot));
        let rows = [[kept; 6], [kept, free, kept, free, free, free], [free, free, free, kept, kept, kept]][round % 3];
        let reference = if round % 2 == 0 { Reference::Identity } else { Reference::Fixed(fixed) };
        let constraint = Constraint::RelativePose(RelativePose { a, b, rows, reference });
        let q = draw.configuration(&robot);
        let argument = parameter(&robot, &constraint, &q, &poses(&kinematics, &[], &q));
        let at_slot = [constraint.at_slot(0)];
        let program = ConstraintProgram::compile(&robot, &kinematics, &at_slot, &[], &[]).unwrap();
        let deviation = program.deviation(&q, &[argument], &mut scratch).unwrap();
        assert!(deviation.rows < 1e-9 && deviation.objects < 1e-9, "{deviation:?}");
    }
    let joint = robot.joint("arm/e0").unwrap();
    let q = draw.configuration(&robot);
    let locked = Constraint::Locked(Locked { joint, value: LockedValue::Argument(0) });
    let argument = parameter(&robot, &locked, &q, &poses(&kinematics, &[], &q));
    assert_eq!(argument.translation.x, q[coordinate(&robot, "arm/e0")]);
    // Zero rows at a fixed reference, and one that is kept.
    let rows = [Some(Row::Zero), Some(Row::Parameter), None, None, None, None];
    let (a, b) = (draw.frame(&robot), draw.frame(&robot));
    let half = Constraint::RelativePose(RelativePose { a, b, rows, reference: Reference::Fixed(fixed) });
    let argument = parameter(&robot, &half, &q, &poses(&kinematics, &[], &q));
    assert_eq!((argument.translation.x, argument.rotation), (0.1, fixed.rotation));
}

/// The hand carries the box, the box its lid: whatever order the constraints have, both are eliminated.
#[test]
fn objects_on_objects_follow_in_any_order() {
    let robot = world();
    let kinematics = Kinematics::new(&robot);
    let joint = |name: &str| Frame::of_joint(robot.joint(name).unwrap());
    let (hand, block, lid) = (joint("arm/w2"), joint("block/root_joint"), joint("lid/root_joint"));
    let other = joint("other/root_joint");
    let at = |x: f64| Pose::from_parts(DVec3::new(x, 0.1, 0.2), foliate_components::pose::exp_so3(DVec3::X * x));
    let rigid = |a, b, x| RelativePose::rigid(a, b, Reference::Fixed(at(x)));
    let back = |pose: RelativePose, x| RelativePose::rigid(pose.b, pose.a, Reference::Fixed(at(x).inverse()));
    let links = [rigid(hand, block, 0.3), rigid(block, lid, 0.5), rigid(lid, other, -0.4)];
    let mut draw = Draw::new(10);
    let start = draw.configuration(&robot);
    let mut first: Option<Vec<Pose>> = None;
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for turned in 0..8 {
            let constraint = |k: usize| {
                let x = [0.3, 0.5, -0.4][k];
                let pose = if turned >> k & 1 == 1 { back(links[k], x) } else { links[k] };
                Constraint::RelativePose(pose)
            };
            let constraints = order.map(constraint);
            let program = ConstraintProgram::compile(&robot, &kinematics, &constraints, &[], &[]).unwrap();
            assert_eq!(
                (program.rows(), program.checks(), program.rigid_attachments().len()),
                (0, 0, 3),
                "{order:?} {turned}"
            );
            let mut q = start.clone();
            let outcome = project(&program, &mut q, &[], &Settings::default(), &mut Scratch::default());
            assert!(outcome.is_converged(), "{outcome:?}");
            let bodies = poses(&kinematics, &[], &q);
            let expected = first.get_or_insert_with(|| bodies.clone());
            for (ours, theirs) in bodies.iter().zip(expected.iter()) {
                assert!(ours.translation.distance(theirs.translation) < 1e-9, "{order:?} {turned}");
            }
            // Forward kinematics takes rigid attachments in any order too.
            let mut rigid_attachments: Vec<RigidAttachment> = Vec::new();
            assert!(program.resolve_attachments(&[], &mut rigid_attachments));
            let ordered = poses(&kinematics, &rigid_attachments, &start);
            rigid_attachments.reverse();
            assert_eq!(poses(&kinematics, &rigid_attachments, &start), ordered);
            rigid_attachments.swap(0, 1);
            assert_eq!(poses(&kinematics, &rigid_attachments, &start), ordered);
        }
    }
    // A second relation on a carried object is a row, not another carrier.
    let drone = joint("drone/elbow");
    let both = [links[1], links[0], rigid(drone, lid, 0.2)].map(Constraint::RelativePose);
    let program = ConstraintProgram::compile(&robot, &kinematics, &both, &[], &[]).unwrap();
    assert_eq!((program.rows(), program.rigid_attachments().len()), (6, 2));
    // Objects that are attached only to each other leave one of them free.
    let floating = [links[1], links[2]].map(Constraint::RelativePose);
    let program = ConstraintProgram::compile(&robot, &kinematics, &floating, &[], &[]).unwrap();
    assert_eq!((program.rows(), program.rigid_attachments().len()), (0, 2));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let bench = Bench::new(11);
    let refused = |constraint| {
        let compiled = ConstraintProgram::compile(&bench.robot, &bench.kinematics, &[constraint], &[], &[]);
        match compiled {
            Err(error @ (CompileError::Malformed { .. } | CompileError::NoSuchJoint { .. })) => error.to_string(),
            other => format!("not refused: {other:?}"),
        }
    };
    let balance = bench.balance(&["human"], Row::Zero);
    let with = |rows: Vec<PlaneRow>| Constraint::CentreOfMass(CentreOfMass { rows, ..balance.clone() });
    let plane = |normal, offset| PlaneRow { normal, offset, row: Row::Zero };
    let a = bench.frame("human/waist");
    let distance = |length, row| {
        Constraint::Distance(Distance { a, b: Frame::world(Pose::identity()), length, row, at_most: false })
    };
    let nowhere = Frame::of_joint(foliate_components::robot::JointIndex(999));
    let between = CentreOfMassBetween { masses: balance.masses.clone(), first: a, second: nowhere, height: None };
    let gaze = Gaze { frames: [a, nowhere] };
    for (constraint, expected) in [
        (with(vec![]), "no rows"),
        (with(vec![plane(DVec3::X, 0.0); 65]), "more than 64 rows"),
        (with(vec![plane(DVec3::X * 2.0, 0.0)]), "unit vector"),
        (with(vec![plane(DVec3::NAN, 0.0)]), "unit vector"),
        (with(vec![plane(DVec3::X, f64::INFINITY)]), "unit vector"),
        (distance(0.0, Row::Zero), "positive"),
        (distance(f64::NAN, Row::Zero), "positive"),
        (distance(0.5, Row::Parameter), "parameter"),
        (Constraint::CentreOfMassBetween(between.clone()), "999"),
        (
            Constraint::CentreOfMassBetween(CentreOfMassBetween { second: a, height: Some(f64::NAN), ..between }),
            "height",
        ),
        (Constraint::Custom(Custom(Arc::new(gaze))), "999"),
    ] {
        let message = refused(constraint);
        assert!(message.contains(expected), "{message}");
    }
}

/// A box in the hand of the sample world weighs there too (the same tree as the Jacobians').
#[test]
fn the_held_box_has_no_freedom_of_its_own() {
    let robot = world();
    let kinematics = Kinematics::new(&robot);
    let carried: Vec<_> = held(&robot).iter().map(|c| AttachmentTemplate::fixed(c.object, c.carrier, c.X_CO)).collect();
    let masses = Masses::of_parts(&robot, &[robot.part("lid").unwrap()]).unwrap();
    let rows = vec![PlaneRow { normal: DVec3::Z, offset: 0.4, row: Row::Zero }];
    let frame = Frame::world(Pose::identity());
    let lid = Constraint::CentreOfMass(CentreOfMass { masses, frame, rows, reference: Reference::Identity });
    let program = ConstraintProgram::compile(&robot, &kinematics, &[lid], &carried, &[]).unwrap();
    // The arm's seven joints and the hinge.
    assert_eq!(program.active().len(), 8);
}
