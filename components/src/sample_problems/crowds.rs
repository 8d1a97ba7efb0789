//! Many arms and many boxes: graphs that nobody can list.

use super::{SIDE, neighbours, standing};
use crate::Pose;
use crate::problem::{Goal, GraphOptions, ObjectOptions, Problem};
use crate::robot::{ComposeError, Robot};
use crate::sample_models::{block, environment, fixed_robot, movable_object, seven_axis_arm, table};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// How far apart arms of one side stand, and how far from the middle of the table, metres.
const APART: f64 = 1.2;
const ASIDE: f64 = 0.8;

/// Eight seven-axis arms, four on either side of a long table, and ten boxes with two handles each: 8 grippers × 20 handles
/// make 9·10⁹ states. Arms are `arm0` … `arm7`, even numbers on the side of negative y; boxes are `box0` … `box9`. One box,
/// in front of the third arm, shall be moved 20 cm along the table.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn eight_arms_and_ten_boxes() -> Result<Problem, ComposeError> {
    let (arm, board, cube) = (seven_axis_arm(), table(DVec3::new(4.4, 1.0, 0.05)), block(DVec3::splat(SIDE)));
    let arms: Vec<_> = (0..8).map(|number| (&arm, fixed_robot(&format!("arm{number}"), mount(number)))).collect();
    let names: Vec<String> = (0..10).map(|number| format!("box{number}")).collect();
    let boxes = names.iter().map(|name| (&cube, movable_object(name)));
    let board = (&board, environment("table", Pose::identity()));
    let parts: Vec<_> = arms.into_iter().chain([board]).chain(boxes).collect();
    let robot = Robot::compose(&parts)?;
    let objects = names.iter().filter_map(|name| {
        Some(ObjectOptions {
            part: robot.part(name)?,
            handles: vec![robot.handle(&format!("{name}/top"))?, robot.handle(&format!("{name}/side"))?],
            surfaces: vec![robot.surface(&format!("{name}/bottom"))?],
            plane: None,
        })
    });
    let graph = GraphOptions {
        grippers: (0..8).filter_map(|number| robot.gripper(&format!("arm{number}/hand"))).collect(),
        objects: objects.collect(),
        supports: robot.surface("table/top").into_iter().collect(),
        placement_margin: 1e-3,
        preplacement_distance: 0.05,
        ..GraphOptions::default()
    };
    let (start, goal) = (configuration(DVec3::ZERO), configuration(DVec3::new(0.2, 0.0, 0.0)));
    let ignored_pairs = neighbours(&robot);
    Ok(Problem {
        name: "eight arms and ten boxes".into(),
        robot,
        graph,
        ignored_pairs,
        margins: Vec::new(),
        start,
        goals: vec![Goal::Configuration(goal)],
    })
}

/// Where an arm stands; it looks across the table.
fn mount(number: u32) -> Pose {
    let side = if number.is_multiple_of(2) { -1.0 } else { 1.0 };
    let along = (f64::from(number / 2) - 1.5) * APART;
    Pose::from_parts(DVec3::new(along, side * ASIDE, 0.3), DQuat::from_rotation_z(-side * FRAC_PI_2))
}

/// All arms bent, and the boxes in two rows, the first of them moved.
fn configuration(first_moved: DVec3) -> Vec<f64> {
    let bent = [0.0, -0.6, 0.0, 1.4, 0.0, 0.8, 0.0];
    let mut q: Vec<f64> = bent.into_iter().cycle().take(8 * bent.len()).collect();
    for number in 0..10 {
        let (row, column) = (f64::from(number % 2), f64::from(number / 2));
        let at = DVec3::new(-0.75 + 0.35 * column, -0.2 + 0.4 * row, 0.5 * SIDE + 1e-3);
        q.extend(standing(if number == 0 { at + first_moved } else { at }));
    }
    q
}
