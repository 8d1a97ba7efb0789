//! Many boxes that one arm or two move to given places on a table.

use crate::Pose;
use crate::constraint::Rests;
use crate::pose::pose_to_array;
use crate::problem::{Goal, GraphOptions, ObjectOptions, Problem};
use crate::robot::error::ComposeError;
use crate::robot::hybrid_robot::Robot;
use crate::samples::boxes::neighbours;
use crate::samples::models::{block, environment, fixed_robot, movable_object, seven_axis_arm, table};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Side of the boxes, metres.
pub const BOX_SIDE: f64 = 0.04;

/// How far each arm stands from the middle of the table, metres. The first stands on the side of negative y.
pub const ARM_DISTANCE: f64 = 0.55;

/// One seven-axis arm or two, `arm0` and `arm1`, that face each other across the origin, and `starts.len()` boxes with one handle
/// each (`box0` …, grasped from above). Box i starts at `starts[i]` and shall end at `goals[i]` (x, y, metres). The table's top, at
/// z = 0, has the size `top` (x, y, metres) and its middle at the origin.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn rearrange_boxes(
    arms: usize,
    top: (f64, f64),
    starts: &[(f64, f64)],
    goals: &[(f64, f64)],
) -> Result<Problem, ComposeError> {
    let (arm, cube) = (seven_axis_arm(), block(DVec3::splat(BOX_SIDE)));
    let board = table(DVec3::new(top.0, top.1, 0.05));
    let mounts = [(-1.0, FRAC_PI_2), (1.0, -FRAC_PI_2)]
        .map(|(side, turn)| Pose::from_parts(DVec3::new(0.0, side * ARM_DISTANCE, 0.3), DQuat::from_rotation_z(turn)));
    let mounts = mounts.into_iter().take(arms).enumerate();
    let fixed: Vec<_> = mounts.map(|(number, mount)| (&arm, fixed_robot(&format!("arm{number}"), mount))).collect();
    let names: Vec<String> = (0..starts.len()).map(|number| format!("box{number}")).collect();
    let movable = names.iter().map(|name| (&cube, movable_object(name)));
    let parts: Vec<_> =
        fixed.into_iter().chain([(&board, environment("table", Pose::identity()))]).chain(movable).collect();
    let robot = Robot::compose(&parts)?;
    let objects = names.iter().filter_map(|name| {
        Some(ObjectOptions {
            part: robot.part(name)?,
            handles: vec![robot.handle(&format!("{name}/top"))?],
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
    let configuration = |places: &[(f64, f64)]| {
        // So far back that the hands of two arms do not meet.
        let bent = [0.0, -1.6, 0.0, 2.4, 0.0, 0.8, 0.0];
        let mut q = bent.repeat(arms.min(2));
        let standing = |&(x, y): &(f64, f64)| Pose::from_translation(DVec3::new(x, y, 0.5 * BOX_SIDE + 1e-3));
        q.extend(places.iter().flat_map(|place| pose_to_array(&standing(place))));
        q
    };
    let (start, goal) = (configuration(starts), configuration(goals));
    let ignored_pairs = neighbours(&robot);
    let name = format!("{} boxes, {arms} arms", starts.len());
    Ok(Problem { graph, ignored_pairs, ..Problem::new(name, robot, start, vec![Goal::Configuration(goal)]) })
}
