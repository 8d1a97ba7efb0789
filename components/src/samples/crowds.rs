//! Many arms and many boxes: graphs that are too large to list.

use crate::Pose;
use crate::constraint::Rests;
use crate::problem::{Goal, GraphOptions, ObjectOptions, Problem};
use crate::robot::error::ComposeError;
use crate::robot::hybrid_robot::Robot;
use crate::samples::boxes::{SIDE, neighbours, standing};
use crate::samples::models::{block, environment, fixed_robot, movable_object, seven_axis_arm, table};
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
    let problem = crowd(8, 10)?;
    Ok(Problem { name: "eight arms and ten boxes".into(), ..problem })
}

/// As [`eight_arms_and_ten_boxes`], with an even number of arms along a table that is long enough, and an even number of
/// boxes, at most 100.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn crowd(arms: u32, boxes: u32) -> Result<Problem, ComposeError> {
    let length = 0.55 * f64::from(arms).max(8.0);
    let (arm, board, cube) = (seven_axis_arm(), table(DVec3::new(length, 1.0, 0.05)), block(DVec3::splat(SIDE)));
    let fixed: Vec<_> = (0..arms).map(|n| (&arm, fixed_robot(&format!("arm{n}"), mount(n, arms)))).collect();
    let names: Vec<String> = (0..boxes).map(|number| format!("box{number}")).collect();
    let movable = names.iter().map(|name| (&cube, movable_object(name)));
    let board = (&board, environment("table", Pose::identity()));
    let parts: Vec<_> = fixed.into_iter().chain([board]).chain(movable).collect();
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
        grippers: (0..arms).filter_map(|number| robot.gripper(&format!("arm{number}/hand"))).collect(),
        objects: objects.collect(),
        supports: robot.surface("table/top").into_iter().collect(),
        placement_margin: 1e-3,
        preplacement_distance: 0.05,
        rests: Rests::Centre,
        ..GraphOptions::default()
    };
    let start = configuration(arms, boxes, DVec3::ZERO);
    // Along the row where there is room, else between the two rows.
    let moved = if boxes > 10 { DVec3::new(0.0, 0.2, 0.0) } else { DVec3::new(0.2, 0.0, 0.0) };
    let goal = configuration(arms, boxes, moved);
    let ignored_pairs = neighbours(&robot);
    Ok(Problem {
        graph,
        ignored_pairs,
        ..Problem::new(format!("{arms} arms and {boxes} boxes"), robot, start, vec![Goal::Configuration(goal)])
    })
}

/// Where an arm stands; it looks across the table.
fn mount(number: u32, arms: u32) -> Pose {
    let side = if number.is_multiple_of(2) { -1.0 } else { 1.0 };
    let along = (f64::from(number / 2) - 0.5 * f64::from(arms / 2 - 1)) * APART;
    Pose::from_parts(DVec3::new(along, side * ASIDE, 0.3), DQuat::from_rotation_z(-side * FRAC_PI_2))
}

/// All arms bent, and the boxes in two rows, the first of them moved.
fn configuration(arms: u32, boxes: u32, first_moved: DVec3) -> Vec<f64> {
    let bent = [0.0, -0.6, 0.0, 1.4, 0.0, 0.8, 0.0];
    let mut q: Vec<f64> = bent.into_iter().cycle().take(arms as usize * bent.len()).collect();
    // Roots may be up to 2 m from the origin.
    let columns = f64::from(boxes / 2);
    let spacing = (3.4 / columns).min(0.35);
    let first = -(0.05 + 0.5 * spacing * (columns - 1.0));
    for number in 0..boxes {
        let (row, column) = (f64::from(number % 2), f64::from(number / 2));
        let at = DVec3::new(first + spacing * column, -0.2 + 0.4 * row, 0.5 * SIDE + 1e-3);
        q.extend(standing(if number == 0 { at + first_moved } else { at }));
    }
    q
}
