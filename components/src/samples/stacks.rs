//! Boxes on boxes: supports that move, and magnets.

use crate::Pose;
use crate::constraint::Rests;
use crate::problem::{Goal, GraphOptions, ObjectOptions, Problem};
use crate::robot::error::ComposeError;
use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{GripperIndex, HandleIndex, SurfaceIndex};
use crate::robot::model::{GripperModel, HandleModel, Model};
use crate::samples::boxes::{bent_arm, neighbours, on_table, standing};
use crate::samples::models::{block, environment, fixed_robot, movable_object, seven_axis_arm, table};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Gap between what lies and what carries it, metres.
const GAP: f64 = 1e-3;
/// The lower box and what lies on it, metres.
const LOWER: DVec3 = DVec3::new(0.06, 0.06, 0.2);
const UPPER: DVec3 = DVec3::new(0.04, 0.04, 0.02);

/// An arm above a table with two blocks, `lower` and `upper`, in this order in a configuration.
fn two_blocks(lower: &Model, upper: &Model) -> Result<Robot, ComposeError> {
    let (arm, board) = (seven_axis_arm(), table(DVec3::new(1.2, 1.6, 0.05)));
    Robot::compose(&[
        (&arm, fixed_robot("arm", Pose::from_translation(DVec3::Z * 0.3))),
        (&board, environment("table", Pose::from_translation(DVec3::new(0.9, 0.0, 0.0)))),
        (lower, movable_object("box")),
        (upper, movable_object("lid")),
    ])
}

fn named(robot: &Robot, surfaces: &[&str]) -> Vec<SurfaceIndex> {
    surfaces.iter().filter_map(|name| robot.surface(name)).collect()
}

fn object(robot: &Robot, part: &str, handles: &[&str]) -> Option<ObjectOptions> {
    Some(ObjectOptions {
        part: robot.part(part)?,
        handles: handles.iter().filter_map(|name| robot.handle(name)).collect(),
        surfaces: named(robot, &[&format!("{part}/bottom")]),
        plane: None,
    })
}

/// What stands where: (x, y, z of the middle).
fn configuration(robot: &Robot, lower: DVec3, upper: DVec3) -> Vec<f64> {
    bent_arm(robot).into_iter().chain(standing(lower)).chain(standing(upper)).collect()
}

fn problem(name: &str, robot: Robot, graph: GraphOptions, start: Vec<f64>, goal: Vec<f64>) -> Problem {
    let ignored_pairs = neighbours(&robot);
    let goals = vec![Goal::Configuration(goal)];
    Problem { graph, ignored_pairs, ..Problem::new(name, robot, start, goals) }
}

fn options(
    robot: &Robot,
    grippers: &[&str],
    supports: &[&str],
    box_handles: &[&str],
    lid_handles: &[&str],
) -> GraphOptions {
    let objects = [object(robot, "box", box_handles), object(robot, "lid", lid_handles)];
    GraphOptions {
        grippers: grippers.iter().filter_map(|name| robot.gripper(name)).collect(),
        objects: objects.into_iter().flatten().collect(),
        supports: named(robot, supports),
        placement_margin: GAP,
        preplacement_distance: 0.05,
        rests: Rests::Centre,
        ..GraphOptions::default()
    }
}

/// A lid that stands beside a box and shall lie on it.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn put_a_lid_on_a_box() -> Result<Problem, ComposeError> {
    let robot = two_blocks(&block(LOWER), &block(UPPER))?;
    let supports = ["table/top", "box/top", "lid/top"];
    let graph = options(&robot, &["arm/hand"], &supports, &["box/side"], &["lid/top"]);
    let below = on_table(0.65, 0.1, LOWER.z, GAP);
    let above = below + DVec3::Z * (0.5 * (LOWER.z + UPPER.z) + GAP);
    let start = configuration(&robot, below, on_table(0.7, -0.2, UPPER.z, GAP));
    let goal = configuration(&robot, below, above);
    Ok(problem("put a lid on a box", robot, graph, start, goal))
}

/// A box that is moved with a lid lying on it; nothing can hold the lid.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn carry_a_box_with_its_lid() -> Result<Problem, ComposeError> {
    let robot = two_blocks(&block(LOWER), &block(UPPER))?;
    let graph = options(&robot, &["arm/hand"], &["table/top", "box/top"], &["box/side"], &[]);
    let above = DVec3::Z * (0.5 * (LOWER.z + UPPER.z) + GAP);
    let (here, there) = (on_table(0.65, 0.15, LOWER.z, GAP), on_table(0.7, -0.15, LOWER.z, GAP));
    let start = configuration(&robot, here, here + above);
    let goal = configuration(&robot, there, there + above);
    Ok(problem("carry a box with its lid", robot, graph, start, goal))
}

/// A box with a magnet on its top and a lid that it holds by a handle underneath: the arm brings the lid, lets the magnet
/// have it, and moves both by the box.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn hold_a_lid_by_a_magnet() -> Result<Problem, ComposeError> {
    let (mut lower, mut upper) = (block(LOWER), block(UPPER));
    let up = Pose::from_rotation(DQuat::from_rotation_y(-FRAC_PI_2));
    let link = "base_link".to_string();
    lower.grippers.push(GripperModel {
        name: "magnet".into(),
        link: link.clone(),
        link_from_gripper: Pose::from_translation(DVec3::Z * (0.5 * LOWER.z + GAP)) * up,
        clearance: 0.03,
    });
    upper.handles.push(HandleModel {
        name: "under".into(),
        link,
        link_from_handle: Pose::from_translation(DVec3::Z * (-0.5 * UPPER.z)) * up,
        clearance: 0.0,
        mask: [true; 6],
        mask_complement: [false; 6],
        approaching_direction: DVec3::X,
    });
    let robot = two_blocks(&lower, &upper)?;
    let mut graph =
        options(&robot, &["arm/hand", "box/magnet"], &["table/top"], &["box/side"], &["lid/top", "lid/under"]);
    let pair = |gripper: &str, handle: &str| -> Option<(GripperIndex, HandleIndex)> {
        Some((robot.gripper(gripper)?, robot.handle(handle)?))
    };
    let table = [pair("arm/hand", "box/side"), pair("arm/hand", "lid/top"), pair("box/magnet", "lid/under")];
    graph.grasps = Some(table.into_iter().flatten().collect());
    let above = DVec3::Z * (0.5 * (LOWER.z + UPPER.z) + GAP);
    let there = on_table(0.7, -0.15, LOWER.z, GAP);
    let start = configuration(&robot, on_table(0.65, 0.15, LOWER.z, GAP), on_table(0.75, 0.0, UPPER.z, GAP));
    let goal = configuration(&robot, there, there + above);
    Ok(problem("hold a lid by a magnet", robot, graph, start, goal))
}
