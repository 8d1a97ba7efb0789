//! Drawers and lids: joints that move only while a gripper holds a handle beyond them.

use crate::Pose;
use crate::constraint::Rests;
use crate::problem::{Goal, GraphOptions, JointRest, ObjectOptions, Problem, RestingJoint};
use crate::robot::error::ComposeError;
use crate::robot::hybrid_robot::Robot;
use crate::samples::boxes::{bent_arm, neighbours, on_table, standing};
use crate::samples::models::{
    block, box_with_lid, drawer, environment, fixed_robot, movable_object, seven_axis_arm, table,
};
use glam::DVec3;

/// Where the drawer's frame is when it is shut.
const SHUT: DVec3 = DVec3::new(1.05, 0.0, 0.35);

/// A drawer in front of an arm that rests as said; it is shut, and the goal is `opened` metres open with empty hands.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn open_a_drawer(rest: JointRest, opened: f64) -> Result<Problem, ComposeError> {
    let (arm, cabinet) = (seven_axis_arm(), drawer());
    let robot = Robot::compose(&[
        (&arm, fixed_robot("arm", Pose::from_translation(DVec3::Z * 0.3))),
        (&cabinet, fixed_robot("cabinet", Pose::from_translation(SHUT))),
    ])?;
    let graph = drawer_options(&robot, rest);
    let (start, goal) = (beside_the_drawer(&robot, 0.0), beside_the_drawer(&robot, opened));
    let ignored_pairs = neighbours(&robot);
    let goals = vec![Goal::Configuration(goal)];
    Ok(Problem { graph, ignored_pairs, ..Problem::new("open a drawer", robot, start, goals) })
}

/// The same with a box in the drawer that no gripper can hold: it moves with the drawer.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn open_a_drawer_with_a_box_in_it(opened: f64) -> Result<Problem, ComposeError> {
    let (arm, cabinet, cube) = (seven_axis_arm(), drawer(), block(DVec3::splat(0.04)));
    let robot = Robot::compose(&[
        (&arm, fixed_robot("arm", Pose::from_translation(DVec3::Z * 0.3))),
        (&cabinet, fixed_robot("cabinet", Pose::from_translation(SHUT))),
        (&cube, movable_object("box")),
    ])?;
    let mut graph = drawer_options(&robot, JointRest::Stays);
    graph.objects.extend(robot.part("box").map(|part| ObjectOptions {
        part,
        handles: Vec::new(),
        surfaces: robot.surface("box/bottom").into_iter().collect(),
        plane: None,
    }));
    graph.supports.extend(robot.surface("cabinet/inside"));
    graph.placement_margin = 1e-3;
    // The floor is 5.5 cm below the drawer's frame.
    let inside = SHUT + DVec3::new(0.02, 0.03, -0.055 + 0.02 + 1e-3);
    let at = |opened: f64| -> Vec<f64> {
        let mut q = beside_the_drawer(&robot, opened);
        q.extend(standing(inside + DVec3::NEG_X * opened));
        q
    };
    let (start, goal) = (at(0.0), at(opened));
    let ignored_pairs = neighbours(&robot);
    let goals = vec![Goal::Configuration(goal)];
    Ok(Problem { graph, ignored_pairs, ..Problem::new("open a drawer with a box in it", robot, start, goals) })
}

fn drawer_options(robot: &Robot, rest: JointRest) -> GraphOptions {
    let object = robot.part("cabinet").map(|part| ObjectOptions {
        part,
        handles: robot.handle("cabinet/knob").into_iter().collect(),
        surfaces: Vec::new(),
        plane: None,
    });
    GraphOptions {
        grippers: robot.gripper("arm/hand").into_iter().collect(),
        objects: object.into_iter().collect(),
        resting_joints: robot.joint("cabinet/slide").map(|joint| RestingJoint { joint, rest }).into_iter().collect(),
        rests: Rests::Centre,
        ..GraphOptions::default()
    }
}

/// The arm aside, where the drawer opens freely, and the drawer's value.
fn beside_the_drawer(robot: &Robot, opened: f64) -> Vec<f64> {
    let mut q = bent_arm(robot);
    q.iter_mut().take(1).for_each(|turned| *turned = 1.2);
    q.into_iter().chain([opened]).collect()
}

/// A box that can be carried by its side, with a lid on a hinge: it shall be elsewhere, the lid open.
///
/// # Errors
/// None in practice: the models are fixed.
pub fn open_a_box_and_move_it() -> Result<Problem, ComposeError> {
    let size = DVec3::new(0.06, 0.06, 0.2);
    let (arm, board, chest) = (seven_axis_arm(), table(DVec3::new(1.2, 1.6, 0.05)), box_with_lid(size));
    let robot = Robot::compose(&[
        (&arm, fixed_robot("arm", Pose::from_translation(DVec3::Z * 0.3))),
        (&board, environment("table", Pose::from_translation(DVec3::new(0.9, 0.0, 0.0)))),
        (&chest, movable_object("chest")),
    ])?;
    let object = robot.part("chest").map(|part| ObjectOptions {
        part,
        handles: ["chest/side", "chest/knob"].into_iter().filter_map(|name| robot.handle(name)).collect(),
        surfaces: robot.surface("chest/bottom").into_iter().collect(),
        plane: None,
    });
    let hinge = robot.joint("chest/hinge").map(|joint| RestingJoint { joint, rest: JointRest::Stays });
    let graph = GraphOptions {
        grippers: robot.gripper("arm/hand").into_iter().collect(),
        objects: object.into_iter().collect(),
        supports: robot.surface("table/top").into_iter().collect(),
        placement_margin: 1e-3,
        preplacement_distance: 0.05,
        resting_joints: hinge.into_iter().collect(),
        rests: Rests::Centre,
        ..GraphOptions::default()
    };
    let at = |place: DVec3, angle: f64| -> Vec<f64> {
        bent_arm(&robot).into_iter().chain(standing(place)).chain([angle]).collect()
    };
    let (start, goal) = (at(on_table(0.6, 0.1, size.z, 1e-3), 0.0), at(on_table(0.65, -0.1, size.z, 1e-3), 0.6));
    let ignored_pairs = neighbours(&robot);
    let goals = vec![Goal::Configuration(goal)];
    Ok(Problem { graph, ignored_pairs, ..Problem::new("open a box and move it", robot, start, goals) })
}
