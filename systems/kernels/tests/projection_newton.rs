//! Projection finds configurations on constraints, within bounds, and says why where it does not.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

use foliate_components::Pose;
use foliate_components::constraint::{
    Constraint, Frame, Grasp, Locked, LockedValue, Placement as Contact, Reference, RelativePose, Row,
};
use foliate_components::pose::exp_so3;
use foliate_components::robot::{PartKind, Robot, RootJoint};
use foliate_components::samples::models;
use foliate_kernels::constrained_motion::{
    AttachmentTemplate, CompileError, ConstraintProgram, Outcome, Relation, Scratch, Settings, project,
};
use foliate_kernels::constraints::{placement, placement_of, relative_pose};
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Two seven-axis arms beside each other, two blocks and a table in front of them.
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

struct Bench {
    robot: Robot,
    kinematics: Kinematics,
    scratch: Scratch,
    rng: ChaCha8Rng,
}

impl Bench {
    fn new(seed: u64) -> Self {
        Self::of(workcell(), seed)
    }

    fn of(robot: Robot, seed: u64) -> Self {
        let kinematics = Kinematics::new(&robot);
        Self { kinematics, robot, scratch: Scratch::default(), rng: ChaCha8Rng::seed_from_u64(seed) }
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

    fn compile(&self, constraints: &[Constraint], rigid_attachments: &[AttachmentTemplate]) -> ConstraintProgram {
        ConstraintProgram::compile(&self.robot, &self.kinematics, constraints, rigid_attachments, &[]).unwrap()
    }

    fn project(&mut self, program: &ConstraintProgram, q: &mut [f64], arguments: &[Pose]) -> Outcome {
        project(program, q, arguments, &Settings::default(), &mut self.scratch)
    }

    fn grasp(&self, gripper: &str, handle: &str) -> Grasp {
        let robot = &self.robot;
        Grasp::new(robot, robot.gripper(gripper).unwrap(), robot.handle(handle).unwrap()).unwrap()
    }

    fn on_table(&self, object: &str) -> Contact {
        let bottom = self.robot.surface(&format!("{object}/bottom")).unwrap();
        Contact::new(&self.robot, &[bottom], &[self.robot.surface("table/top").unwrap()], 1e-3).unwrap()
    }
}

fn worst(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// A program that moves the left hand's frame to argument 0.
fn reach(bench: &Bench) -> ConstraintProgram {
    let grasp = bench.grasp("left/hand", "block/top");
    let rigid = RelativePose::rigid(Frame::world(Pose::identity()), grasp.gripper, Reference::Argument(0));
    bench.compile(&[Constraint::RelativePose(rigid)], &[])
}

#[test]
fn a_reach_is_seven_variables_and_six_rows() {
    let bench = Bench::new(0);
    let program = reach(&bench);
    assert_eq!((program.active().len(), program.rows(), program.checks(), program.arguments()), (7, 6, 0, 1));
    assert_eq!(program.variables().len(), bench.robot.space.dimension());
    assert!(program.rigid_attachments().is_empty());
}

#[test]
fn half_of_random_starts_reach_random_reachable_poses() {
    let mut bench = Bench::new(11);
    let program = reach(&bench);
    let gripper = placement_of(&bench.grasp("left/hand", "block/top").gripper);
    let (tries, mut successes, mut iterations) = (4000, 0, 0);
    for _ in 0..tries {
        let target = bench.random();
        let X_WT = gripper.in_world(&bench.poses(&target));
        let mut q = bench.random();
        let before = q.clone();
        if let Outcome::Converged { iterations: n, residual } = bench.project(&program, &mut q, &[X_WT]) {
            successes += 1;
            iterations += n;
            assert!(residual <= 1e-6);
            assert!(bench.robot.space.first_out_of_bounds(&q, 0.0).is_none(), "bounds hold exactly");
            let reached = gripper.in_world(&bench.poses(&q));
            assert!((reached.translation - X_WT.translation).length() < 2e-6);
            assert_eq!(q[7..], before[7..], "coordinates that no row depends on keep their values");
        }
    }
    let share = f64::from(successes) / f64::from(tries);
    println!("success {share:.3}, {:.1} iterations per success", f64::from(iterations) / f64::from(successes));
    assert!(share >= 0.49, "success {share}");
}

#[test]
fn a_grasp_of_a_placed_block_is_the_arms_problem_alone() {
    let mut bench = Bench::new(12);
    let block = bench.robot.joint("block/root_joint").unwrap();
    let grasp = bench.grasp("left/hand", "block/top");
    for constraint in [grasp.constraint(), grasp.pregrasp()] {
        let program =
            bench.compile(&[Constraint::RelativePose(constraint)], &[AttachmentTemplate::argument(block, None, 0)]);
        assert_eq!((program.active().len(), program.rows()), (7, 6));
        let X_WO = Pose::from_translation(DVec3::new(0.75, 0.3, 0.1));
        let mut solved = 0;
        for _ in 0..100 {
            let mut q = bench.random();
            if !bench.project(&program, &mut q, &[X_WO]).is_converged() {
                continue;
            }
            solved += 1;
            let X_WJ = bench.poses(&q);
            assert_eq!(X_WJ[block.at()], X_WO, "the leaf's pose, bit for bit");
            let (a, b) = (placement_of(&constraint.a), placement_of(&constraint.b));
            assert!(worst(&relative_pose::value(&a, &b, &Pose::identity(), &X_WJ)) < 1.1e-6);
        }
        assert!(solved > 20, "{solved}");
    }
}

#[test]
fn grasp_and_placement_together_eliminate_the_object() {
    let mut bench = Bench::new(13);
    let contact = bench.on_table("block");
    let grasp = bench.grasp("left/hand", "block/top");
    let constraints = [Constraint::Placement(contact.clone()), Constraint::RelativePose(grasp.constraint())];
    let program = bench.compile(&constraints, &[]);
    assert_eq!((program.active().len(), program.rows(), program.rigid_attachments().len()), (7, 5, 1));
    let mut solved = 0;
    for _ in 0..200 {
        let mut q = bench.random();
        if !bench.project(&program, &mut q, &[]).is_converged() {
            continue;
        }
        solved += 1;
        let X_WJ = bench.poses(&q);
        let pair = placement::contact(&contact, &X_WJ);
        assert!(pair.inside);
        assert!(worst(&placement::value(&contact, pair, &X_WJ)) < 1.1e-6);
        let (a, b) = (placement_of(&grasp.gripper), placement_of(&grasp.handle));
        assert!(worst(&relative_pose::value(&a, &b, &Pose::identity(), &X_WJ)) < 1e-9, "explicit: no residual");
    }
    assert!(solved > 100, "{solved}");
}

#[test]
fn constraint_and_complement_merge_and_eliminate() {
    let mut bench = Bench::new(14);
    let axial = bench.grasp("left/hand", "block/side");
    let apart = [Constraint::RelativePose(axial.constraint()), Constraint::RelativePose(axial.complement(0))];
    let program = bench.compile(&apart, &[]);
    assert_eq!((program.active().len(), program.rows(), program.rigid_attachments().len()), (0, 0, 1));
    assert_eq!(program.rigid_attachments()[0].carrier, bench.robot.joint("left/w2"));
    let parameter = Pose::from_rotation(exp_so3(DVec3::Z * 0.8));
    let mut q = bench.random();
    assert_eq!(bench.project(&program, &mut q, &[parameter]), Outcome::Converged { iterations: 0, residual: 0.0 });
    let X_WJ = bench.poses(&q);
    let held = relative_pose::pose(&placement_of(&axial.gripper), &placement_of(&axial.handle), &X_WJ);
    assert!((held.translation).length() < 1e-12 && held.rotation.dot(parameter.rotation).abs() > 1.0 - 1e-14);
    // Without the complement the grasp leaves a freedom and eliminates nothing.
    let program = bench.compile(&apart[..1], &[]);
    assert_eq!((program.active().len(), program.rows(), program.rigid_attachments().len()), (13, 5, 0));

    let contact = bench.on_table("block");
    let both = [Constraint::PlacementComplement(contact.clone(), 0), Constraint::Placement(contact.clone())];
    let program = bench.compile(&both, &[]);
    assert!(matches!(program.rigid_attachments()[0].relation, Relation::Hold { .. }));
    let parameter = Pose::from_parts(DVec3::new(0.0, 0.1, -0.2), exp_so3(DVec3::X * 2.0));
    let mut q = bench.random();
    assert!(bench.project(&program, &mut q, &[parameter]).is_converged());
    let X_WJ = bench.poses(&q);
    let again = placement::parameter(&contact, &X_WJ);
    assert!((again.translation - parameter.translation).length() < 1e-12);
}

#[test]
fn two_hands_on_one_block() {
    let mut bench = Bench::new(15);
    let left = bench.grasp("left/hand", "block/top");
    // The right hand comes from the opposite side.
    let turned = Pose::from_rotation(exp_so3(DVec3::Y * std::f64::consts::PI));
    let right = RelativePose { b: left.handle.then(&turned), ..bench.grasp("right/hand", "block/top").constraint() };
    let program = bench.compile(&[Constraint::RelativePose(left.constraint()), Constraint::RelativePose(right)], &[]);
    assert_eq!((program.active().len(), program.rows(), program.rigid_attachments().len()), (14, 6, 1));
    let mut solved = 0;
    for _ in 0..200 {
        let mut q = bench.random();
        if !bench.project(&program, &mut q, &[]).is_converged() {
            continue;
        }
        solved += 1;
        let X_WJ = bench.poses(&q);
        for constraint in [left.constraint(), right] {
            let (a, b) = (placement_of(&constraint.a), placement_of(&constraint.b));
            assert!(worst(&relative_pose::value(&a, &b, &Pose::identity(), &X_WJ)) < 1.1e-6);
        }
        assert!(bench.robot.space.first_out_of_bounds(&q, 0.0).is_none_or(|i| i >= 14), "objects have no say");
    }
    assert!(solved > 100, "closure {solved} of 200");
}

#[test]
fn templates_on_a_carried_object_become_rows_too() {
    let bench = Bench::new(16);
    let block = bench.robot.joint("block/root_joint").unwrap();
    let hands = [bench.robot.joint("left/w2"), bench.robot.joint("right/w2")];
    let X_CO = Pose::from_translation(DVec3::Z * 0.2);
    let templates =
        [AttachmentTemplate::fixed(block, hands[0], X_CO), AttachmentTemplate::argument(block, hands[1], 3)];
    let program = bench.compile(&[], &templates);
    assert_eq!((program.active().len(), program.rows(), program.arguments()), (14, 6, 4));
}

#[test]
fn objects_stack_in_any_order_and_cycles_are_refused() {
    let mut bench = Bench::new(17);
    let (block, other) =
        (bench.robot.joint("block/root_joint").unwrap(), bench.robot.joint("other/root_joint").unwrap());
    let hand = bench.robot.joint("left/w2");
    let X = Pose::from_translation(DVec3::Z * 0.12);
    // The upper one is named first.
    let templates = [AttachmentTemplate::fixed(other, Some(block), X), AttachmentTemplate::fixed(block, hand, X)];
    let program = bench.compile(&[], &templates);
    assert_eq!(program.rigid_attachments()[0].object, block);
    let mut q = bench.random();
    assert!(bench.project(&program, &mut q, &[]).is_converged());
    let X_WJ = bench.poses(&q);
    assert!((X_WJ[other.at()].translation - (X_WJ[hand.unwrap().at()] * X * X).translation).length() < 1e-12);

    let cycle = [AttachmentTemplate::fixed(other, Some(block), X), AttachmentTemplate::fixed(block, Some(other), X)];
    let compiled = ConstraintProgram::compile(&bench.robot, &bench.kinematics, &[], &cycle, &[]);
    assert_eq!(compiled.unwrap_err(), CompileError::Cycle("block/root_joint".into()));
    let compiled = ConstraintProgram::compile(
        &bench.robot,
        &bench.kinematics,
        &[],
        &[AttachmentTemplate::fixed(hand.unwrap(), None, X)],
        &[],
    );
    assert_eq!(compiled.unwrap_err(), CompileError::NotAnObject("left/w2".into()));
}

#[test]
fn a_leaf_parameter_never_drifts() {
    let mut bench = Bench::new(18);
    let contact = bench.on_table("block");
    let grasp = bench.grasp("left/hand", "block/top");
    let block = bench.robot.joint("block/root_joint").unwrap();
    // Find a placement that can be grasped, and intern where the block lies.
    let constraints = [Constraint::Placement(contact), Constraint::RelativePose(grasp.constraint())];
    let intersection = bench.compile(&constraints, &[]);
    let mut q = bench.random();
    while !bench.project(&intersection, &mut q, &[]).is_converged() {
        q = bench.random();
    }
    let X_WO = bench.poses(&q)[block.at()];
    let held = bench.compile(&constraints[1..], &[]);
    let placed = AttachmentTemplate::argument(block, None, 0);
    let regrasp = bench.compile(&constraints[1..], std::slice::from_ref(&placed));
    let coordinates = bench.robot.space.size() - 14..bench.robot.space.size() - 7;
    let mut rounds = 0;
    let mut written: Option<Vec<f64>> = None;
    while rounds < 100 {
        // Carry it somewhere else, put it back onto its leaf.
        let mut away = bench.random();
        assert!(bench.project(&held, &mut away, &[]).is_converged());
        if !bench.project(&regrasp, &mut away, &[X_WO]).is_converged() {
            continue;
        }
        rounds += 1;
        assert_eq!(bench.poses(&away)[block.at()], X_WO);
        let numbers = away[coordinates.clone()].to_vec();
        let first = written.get_or_insert_with(|| numbers.clone());
        assert!(first.iter().zip(&numbers).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
}

#[test]
fn saturated_joints_end_on_their_bounds_exactly() {
    let two = models::two_joint_arm();
    let mut placement = models::fixed_robot("two", Pose::identity());
    placement.joint_bounds = vec![("elbow".into(), -0.5, 0.5), ("shoulder".into(), -1.0, 1.0)];
    let mut bench = Bench::of(Robot::compose(&[(&two, placement)]).unwrap(), 20);
    let gripper = &bench.robot.grippers[0];
    let tip = Frame::on_link(&bench.robot, gripper.link, &gripper.link_from_gripper);
    let only_x = [Some(Row::Parameter), None, None, None, None, None];
    let pose =
        RelativePose { a: Frame::world(Pose::identity()), b: tip, rows: only_x, reference: Reference::Argument(0) };
    let program = bench.compile(&[Constraint::RelativePose(pose)], &[]);
    // The tip reaches x = cos 1 + cos 1.5 at the least, with both joints on their bounds.
    let least = 1.0_f64.cos() + 1.5_f64.cos();
    let at = |x: f64| [Pose::from_translation(DVec3::X * x)];
    let mut q = vec![0.4, 0.1];
    assert!(bench.project(&program, &mut q, &at(least)).is_converged());
    assert!(bench.robot.space.first_out_of_bounds(&q, 0.0).is_none());
    let mut q = vec![0.4, 0.1];
    let outcome = bench.project(&program, &mut q, &at(least - 0.2));
    assert!(matches!(outcome, Outcome::Stagnated { residual, .. } if (residual - 0.2).abs() < 1e-9), "{outcome:?}");
    assert_eq!(q, [1.0, 0.5], "stopped in the corner");
    // A start outside the bounds is no obstacle.
    let mut q = vec![7.0, -7.0];
    assert!(bench.project(&program, &mut q, &at(1.5)).is_converged());
    assert!(bench.robot.space.first_out_of_bounds(&q, 0.0).is_none());
}

#[test]
fn locked_joints_are_no_variables() {
    let mut bench = Bench::new(21);
    let (e0, e1) = (bench.robot.joint("left/e0").unwrap(), bench.robot.joint("left/e1").unwrap());
    let grasp = bench.grasp("left/hand", "block/top");
    let rigid = RelativePose::rigid(Frame::world(Pose::identity()), grasp.gripper, Reference::Argument(0));
    let constraints = [
        Constraint::RelativePose(RelativePose { rows: [Some(Row::Parameter), None, None, None, None, None], ..rigid }),
        Constraint::Locked(Locked { joint: e1, value: LockedValue::Argument(1) }),
        Constraint::Locked(Locked { joint: e0, value: LockedValue::Fixed(0.25) }),
    ];
    let locked = [(e0, 0.25)];
    let compile = |constraints: &[Constraint]| {
        ConstraintProgram::compile(&bench.robot, &bench.kinematics, constraints, &[], &locked).unwrap()
    };
    let program = compile(&constraints);
    let contradiction = compile(&[Constraint::Locked(Locked { joint: e0, value: LockedValue::Fixed(0.5) })]);
    assert_eq!((program.active().len(), program.rows(), program.checks()), (5, 1, 1));
    let mut q = bench.random();
    let arguments = [Pose::from_translation(DVec3::X * 0.5), Pose::from_translation(DVec3::X * 1.25)];
    assert!(bench.project(&program, &mut q, &arguments).is_converged());
    assert_eq!((q[2], q[3]), (0.25, 1.25));
    let deviation = program.deviation(&q, &arguments, &mut bench.scratch).unwrap();
    assert!(deviation.rows <= 1e-6 && deviation.objects == 0.0);
    let outcome = bench.project(&contradiction, &mut q, &[]);
    assert_eq!(outcome, Outcome::Contradicted { constraint: 0, residual: 0.25 });
    let hinge = ConstraintProgram::compile(
        &bench.robot,
        &bench.kinematics,
        &[],
        &[],
        &[(bench.robot.joint("block/root_joint").unwrap(), 0.0)],
    );
    assert!(matches!(hinge, Err(CompileError::NotLockable(_))));
}

#[test]
fn what_no_variable_touches_is_checked_before_any_iteration() {
    let mut bench = Bench::new(22);
    let block = bench.robot.joint("block/root_joint").unwrap();
    let contact = bench.on_table("block");
    let placed = [AttachmentTemplate::argument(block, None, 0)];
    let program = bench.compile(&[Constraint::Placement(contact.clone())], &placed);
    assert_eq!((program.rows(), program.checks()), (0, 1));
    let (_, X_WO) = placement::hold(&contact, &Pose::from_translation(DVec3::new(0.0, 0.1, 0.1))).unwrap();
    let mut q = bench.random();
    assert!(bench.project(&program, &mut q, &[X_WO]).is_converged());
    let above = Pose::from_translation(DVec3::Z * 0.1) * X_WO;
    let outcome = bench.project(&program, &mut q, &[above]);
    assert!(matches!(outcome, Outcome::Contradicted { constraint: 1, residual } if (residual - 0.1).abs() < 1e-12));
    // Membership of a configuration as it is.
    let at = bench.poses(&q)[block.at()];
    let deviation = program.deviation(&q, &[at], &mut bench.scratch).unwrap();
    assert!(deviation.objects < 1e-15);
    let moved = Pose::from_translation(DVec3::Y * 0.02) * at;
    assert!((program.deviation(&q, &[moved], &mut bench.scratch).unwrap().objects - 0.02).abs() < 1e-12);
}

#[test]
fn bad_input_is_malformed_and_nothing_panics() {
    let mut bench = Bench::new(23);
    let program = reach(&bench);
    let mut q = bench.random();
    assert_eq!(bench.project(&program, &mut q, &[]), Outcome::Malformed);
    assert_eq!(bench.project(&program, &mut q[..3], &[Pose::identity()]), Outcome::Malformed);
    let nan = Pose::from_translation(DVec3::NAN);
    assert_eq!(bench.project(&program, &mut q, &[nan]), Outcome::Malformed);
    q[0] = f64::INFINITY;
    assert_eq!(bench.project(&program, &mut q, &[Pose::identity()]), Outcome::Malformed);
    let far = Pose::from_translation(DVec3::X * 1e300);
    let mut q = bench.random();
    assert!(!bench.project(&program, &mut q, &[far]).is_converged());
    // A placement's parameter that names polygons that are not there.
    let contact = bench.on_table("block");
    let hold = bench.compile(&[Constraint::PlacementHold(contact, 0)], &[]);
    assert_eq!(bench.project(&hold, &mut q, &[Pose::from_translation(DVec3::Y * 90.0)]), Outcome::Malformed);
    let frame = Frame { joint: Some(foliate_components::robot::JointIndex(999)), joint_from_frame: Pose::identity() };
    let rigid = RelativePose::rigid(frame, frame, Reference::Identity);
    let unknown =
        ConstraintProgram::compile(&bench.robot, &bench.kinematics, &[Constraint::RelativePose(rigid)], &[], &[]);
    assert!(matches!(unknown, Err(CompileError::NoSuchJoint { constraint: 0, .. })));
}

#[test]
fn roots_followers_and_articulated_objects() {
    let (hand, two, lid) =
        (models::two_finger_hand(), models::two_joint_arm(), models::box_with_lid(DVec3::new(0.1, 0.14, 0.2)));
    let tilted = Pose::from_parts(DVec3::new(0.1, 0.0, 0.2), exp_so3(DVec3::new(0.0, 0.3, 0.2)));
    let drone = foliate_components::robot::PartPlacement {
        root_bounds: vec![(-1.0, 1.0); 3],
        ..models::part("drone", PartKind::Robot, RootJoint::FreeFlyer, tilted)
    };
    let mut bench = Bench::of(
        Robot::compose(&[
            (&hand, models::fixed_robot("hand", tilted)),
            (&two, models::part("rover", PartKind::Robot, RootJoint::Planar, Pose::identity())),
            (&two, drone),
            (&lid, models::movable_object("lid")),
        ])
        .unwrap(),
        24,
    );
    // Fingers 5 cm apart: the follower moves with its leader.
    let finger = |name: &str| Frame::of_joint(bench.robot.joint(name).unwrap());
    let apart = RelativePose {
        a: finger("hand/right_finger"),
        b: finger("hand/left_finger"),
        rows: [None, Some(Row::Zero), None, None, None, None],
        reference: Reference::Fixed(Pose::from_translation(DVec3::Y * 0.05)),
    };
    let program = bench.compile(&[Constraint::RelativePose(apart)], &[]);
    assert_eq!(program.active().len(), 1);
    let mut q = bench.random();
    assert!(bench.project(&program, &mut q, &[]).is_converged());
    assert!((q[0] - 0.025).abs() < 1e-6);

    // The drone holds the knob while the rover, on its plane, holds the box: 5 + 8 + the lid's hinge.
    let [knob, side] = ["lid/knob", "lid/side"].map(|h| bench.robot.handle(h).unwrap());
    let grasp = |g: &str, h| Grasp::new(&bench.robot, bench.robot.gripper(g).unwrap(), h).unwrap();
    let constraints = [
        Constraint::RelativePose(grasp("rover/tip", side).hold(0)),
        Constraint::RelativePose(grasp("drone/tip", knob).constraint()),
    ];
    let program = bench.compile(&constraints, &[]);
    assert_eq!((program.rigid_attachments().len(), program.rows(), program.active().len()), (1, 6, 5 + 8 + 1));
    let mut solved = 0;
    for _ in 0..50 {
        let mut q = bench.random();
        let parameter = Pose::from_rotation(exp_so3(DVec3::Z * 0.5));
        if bench.project(&program, &mut q, &[parameter]).is_converged() {
            solved += 1;
            assert!(program.deviation(&q, &[parameter], &mut bench.scratch).unwrap().rows <= 1e-6);
            let full = bench.poses(&q);
            let grasp = grasp_values(&bench.robot, &full);
            assert!(worst(&grasp) < 1.1e-6, "{grasp:?}");
        }
    }
    assert!(solved > 20, "{solved}");
}

fn grasp_values(robot: &Robot, X_WJ: &[Pose]) -> [f64; 6] {
    let grasp = Grasp::new(robot, robot.gripper("drone/tip").unwrap(), robot.handle("lid/knob").unwrap()).unwrap();
    relative_pose::value(&placement_of(&grasp.gripper), &placement_of(&grasp.handle), &Pose::identity(), X_WJ)
}

/// A relation between two bodies that move together has one value wherever they are.
#[test]
fn what_a_hand_carries_is_compared_with_the_hand() {
    let mut bench = Bench::new(11);
    let grasp = bench.grasp("left/hand", "block/top");
    let in_hand = grasp.gripper.joint_from_frame * grasp.handle.joint_from_frame.inverse();
    let hand = Frame { joint: grasp.gripper.joint, joint_from_frame: in_hand };
    let block = Frame::of_joint(grasp.handle.joint.unwrap());
    let relation = |by: f64| {
        let reference = Reference::Fixed(Pose::from_translation(DVec3::X * by));
        Constraint::RelativePose(RelativePose::rigid(hand, block, reference))
    };
    let lifted = |height: f64| {
        let rows = [None, None, Some(Row::Zero), None, None, None];
        let a = Frame::world(Pose::from_translation(DVec3::Z * height));
        Constraint::RelativePose(RelativePose { a, b: block, rows, reference: Reference::Identity })
    };
    let mut q = bench.random();
    let program = bench.compile(&[Constraint::RelativePose(grasp.constraint()), relation(0.0), lifted(0.4)], &[]);
    assert_eq!(program.checks(), 1);
    assert!(bench.project(&program, &mut q, &[]).is_converged());
    let program = bench.compile(&[Constraint::RelativePose(grasp.constraint()), relation(0.01), lifted(0.4)], &[]);
    let outcome = bench.project(&program, &mut q, &[]);
    let is_told = |residual: f64| (residual - 0.01).abs() < 1e-12;
    let told = matches!(outcome, Outcome::Contradicted { constraint: 1, residual } if is_told(residual));
    assert!(told, "{outcome:?}");
}
