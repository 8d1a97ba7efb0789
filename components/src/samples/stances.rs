//! States of a problem's own: a foot that stands, is lifted and is set down elsewhere.

use crate::Pose;
use crate::constraint::Rests;
use crate::constraint::kind::Constraint;
use crate::constraint::{Frame, Reference, RelativePose, Row};
use crate::problem::{Goal, GraphOptions, NamedConstraint, Problem, WrittenLeg, WrittenState, WrittenTransition};
use crate::robot::error::ComposeError;
use crate::robot::hybrid_robot::Robot;
use crate::robot::joint::JointType;
use crate::samples::boxes::{move_one_box, neighbours};
use crate::samples::models::{fixed_robot, seven_axis_arm};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Height of the ground on which the foot stands, metres.
const HEIGHT: f64 = 0.2;

/// The frame of the arm's gripper, x along the approach.
fn hand(robot: &Robot) -> Option<Frame> {
    let gripper = &robot.grippers[robot.gripper("arm/hand")?.at()];
    Some(Frame::on_link(robot, gripper.link, &gripper.link_from_gripper))
}

/// In the world, x down.
fn down(height: f64) -> Frame {
    Frame::world(Pose::from_parts(DVec3::Z * height, DQuat::from_rotation_y(FRAC_PI_2)))
}

/// Where a frame of the arm is; all joints are revolute and in one chain.
fn place(robot: &Robot, q: &[f64], frame: &Frame) -> Pose {
    let mut pose = Pose::identity();
    for (joint, &angle) in robot.joints.iter().zip(q) {
        if let JointType::Revolute { axis } = joint.motion {
            pose = pose * joint.parent_from_joint * Pose::from_rotation(DQuat::from_axis_angle(axis, angle));
        }
    }
    pose * frame.joint_from_frame
}

/// Joint values that set the foot down at that height: the shoulder is turned and bent as said, the elbow found by
/// bisection, the wrist makes the hand point down.
fn stance(robot: &Robot, foot: &Frame, height: f64, [turned, bent]: [f64; 2]) -> Vec<f64> {
    let q = |elbow: f64| vec![turned, bent, 0.0, elbow, 0.0, FRAC_PI_2 - bent - elbow, 0.0];
    // Bending the elbow lowers the hand.
    let (mut high, mut low) = (0.3, 2.0);
    for _ in 0..60 {
        let elbow = 0.5 * (high + low);
        if place(robot, &q(elbow), foot).translation.z > height { high = elbow } else { low = elbow }
    }
    q(high)
}

/// One box that is moved aside by a hand that always points down, as if it were full of water.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn move_one_box_with_a_level_hand() -> Result<Problem, ComposeError> {
    let mut problem = move_one_box()?;
    let zero = Some(Row::Zero);
    let rows = [None, None, None, None, zero, zero];
    let level = hand(&problem.robot)
        .map(|hand| RelativePose { a: down(0.0), b: hand, rows, reference: Reference::Identity })
        .map(|level| NamedConstraint { name: "level".into(), constraint: Constraint::RelativePose(level) });
    problem.graph.constraints.extend(level);
    problem.graph.everywhere = vec![0];
    // Joints that bring the hand over the table, pointing down: shoulder + elbow + wrist make half a turn.
    for q in [&mut problem.start].into_iter().chain(problem.goals.iter_mut().filter_map(|goal| match goal {
        Goal::Configuration(q) => Some(q),
        Goal::Partial(_) => None,
    })) {
        q[..7].copy_from_slice(&[0.0, -0.6, 0.0, 1.4, 0.0, FRAC_PI_2 - 0.8, 0.0]);
    }
    Ok(problem)
}

/// An arm whose hand is a foot: in `standing` it points down on the ground at height 0.2 m and its place and turn are the
/// leaf; in `lifted` it is free. `step` sets the foot down, `lift` takes it up. It stands, and shall stand elsewhere.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn make_a_step() -> Result<Problem, ComposeError> {
    let arm = seven_axis_arm();
    let robot = Robot::compose(&[(&arm, fixed_robot("arm", Pose::from_translation(DVec3::Z * 0.3)))])?;
    let (zero, parameter) = (Some(Row::Zero), Some(Row::Parameter));
    // x of `down` is vertical: y and z are the place on the ground, rx is the turn.
    let rows = [zero, parameter, parameter, parameter, zero, zero];
    let ends = hand(&robot).map(|foot| [[0.0, -0.6], [0.5, -0.4]].map(|bent| stance(&robot, &foot, HEIGHT, bent)));
    let [start, goal] = ends.unwrap_or_default();
    let foot =
        hand(&robot).map(|foot| RelativePose { a: down(HEIGHT), b: foot, rows, reference: Reference::Argument(0) });
    let foot = foot
        .map(|foot| NamedConstraint { name: "foot on the ground".into(), constraint: Constraint::RelativePose(foot) });
    let transition = |name: &str, from, to, within| WrittenTransition {
        name: name.into(),
        from,
        to,
        legs: vec![WrittenLeg { within, until: Vec::new(), short: false }],
    };
    let graph = GraphOptions {
        constraints: foot.into_iter().collect(),
        states: vec![
            WrittenState { name: "standing".into(), constraints: vec![0] },
            WrittenState { name: "lifted".into(), constraints: Vec::new() },
        ],
        transitions: vec![transition("lift", 0, 1, 1), transition("step", 1, 0, 1)],
        rests: Rests::Centre,
        ..GraphOptions::default()
    };
    let (ignored_pairs, goals) = (neighbours(&robot), vec![Goal::Configuration(goal)]);
    Ok(Problem { graph, ignored_pairs, ..Problem::new("make a step", robot, start, goals) })
}
