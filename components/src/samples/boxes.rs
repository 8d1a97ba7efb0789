//! Small manipulation problems in code, for tests, benches and examples that load no files.

use crate::Pose;
use crate::constraint::Rests;
use crate::pose::pose_to_array;
use crate::problem::{Goal, GraphOptions, ObjectOptions, Problem, RestingPlane};
use crate::robot::JoinedLinks;
use crate::robot::error::ComposeError;
use crate::robot::hybrid_robot::{DisabledPair, Robot};
use crate::samples::models::{block, environment, fixed_robot, movable_object, seven_axis_arm, table};
use glam::{DQuat, DVec3};

/// Side of the boxes, metres.
pub(crate) const SIDE: f64 = 0.06;

/// Pairs of links that one joint joins: the samples' overlap where they meet.
pub(crate) fn neighbours(robot: &Robot) -> Vec<DisabledPair> {
    let adjacent = |pair: JoinedLinks| pair.disabled(DisabledPair::ADJACENT);
    robot.parts.iter().flat_map(|part| robot.joined_links(part)).map(adjacent).collect()
}

/// The arm's joints where it keeps out of the way; it must be the first part.
pub(crate) fn bent_arm(robot: &Robot) -> Vec<f64> {
    let mut q = vec![0.0; robot.parts.first().map_or(0, |arm| arm.joints.len())];
    q.iter_mut().zip([0.0, -0.6, 0.0, 1.4, 0.0, 0.8, 0.0]).for_each(|(value, bent)| *value = bent);
    q
}

/// The middle of a box of that height that stands on a table whose top is the ground.
pub(crate) fn on_table(x: f64, y: f64, height: f64, gap: f64) -> DVec3 {
    DVec3::new(x, y, 0.5 * height + gap)
}

/// Coordinates of an object that stands upright.
pub(crate) fn standing(at: DVec3) -> [f64; 7] {
    pose_to_array(&Pose::from_translation(at))
}

/// One seven-axis arm above a table with `starts.len()` boxes; box i starts at `starts[i]` and shall end at `goals[i]`
/// (x, y on the table, metres).
///
/// # Errors
/// None in practice: the models are fixed.
pub fn boxes_on_a_table(starts: &[(f64, f64)], goals: &[(f64, f64)]) -> Result<Problem, ComposeError> {
    let (arm, board, cube) = (seven_axis_arm(), table(DVec3::new(1.2, 1.6, 0.05)), block(DVec3::splat(SIDE)));
    let mut parts = vec![
        (&arm, fixed_robot("arm", Pose::from_translation(DVec3::Z * 0.3))),
        (&board, environment("table", Pose::from_translation(DVec3::new(0.9, 0.0, 0.0)))),
    ];
    for index in 0..starts.len() {
        parts.push((&cube, movable_object(&format!("box{index}"))));
    }
    let robot = Robot::compose(&parts)?;
    let names: Vec<String> = (0..starts.len()).map(|i| format!("box{i}")).collect();
    let objects = names.iter().filter_map(|name| {
        Some(ObjectOptions {
            part: robot.part(name)?,
            handles: vec![robot.handle(&format!("{name}/top"))?],
            surfaces: vec![robot.surface(&format!("{name}/bottom"))?],
            plane: None,
        })
    });
    let graph = GraphOptions {
        grippers: robot.gripper("arm/hand").into_iter().collect(),
        objects: objects.collect(),
        supports: robot.surface("table/top").into_iter().collect(),
        placement_margin: 1e-3,
        preplacement_distance: 0.05,
        rests: Rests::Centre,
        ..GraphOptions::default()
    };
    let configuration = |places: &[(f64, f64)]| {
        let mut q = vec![0.0; robot.space.size() - 7 * places.len()];
        for (value, bent) in q.iter_mut().zip([0.0, -0.6, 0.0, 1.4, 0.0, 0.8, 0.0]) {
            *value = bent;
        }
        for &(x, y) in places {
            let at = Pose::from_parts(DVec3::new(x, y, 0.5 * SIDE + 1e-3), DQuat::IDENTITY);
            q.extend(pose_to_array(&at));
        }
        q
    };
    let (start, goal) = (configuration(starts), configuration(goals));
    let ignored_pairs = neighbours(&robot);
    Ok(Problem {
        graph,
        ignored_pairs,
        ..Problem::new("boxes on a table", robot, start, vec![Goal::Configuration(goal)])
    })
}

/// Two boxes that change places: the smallest problem that no monotone plan solves (P0 §III-B's example).
///
/// # Errors
/// As [`boxes_on_a_table`].
pub fn swap_two_boxes() -> Result<Problem, ComposeError> {
    let (a, b) = ((0.6, 0.15), (0.6, -0.15));
    boxes_on_a_table(&[a, b], &[b, a])
}

/// One box that is moved aside.
///
/// # Errors
/// As [`boxes_on_a_table`].
pub fn move_one_box() -> Result<Problem, ComposeError> {
    boxes_on_a_table(&[(0.6, 0.15)], &[(0.7, -0.2)])
}

/// Two boxes that change places, both sides foliated: they stand on a plane, and the grasp leaves the turn about the
/// approach axis free. Trees that grow from start and goal share no grasp (P1 §I-A, figure 2).
///
/// # Errors
/// As [`boxes_on_a_table`].
pub fn swap_with_crossed_foliations() -> Result<Problem, ComposeError> {
    let mut problem = swap_two_boxes()?;
    for object in &mut problem.graph.objects {
        object.surfaces.clear();
        object.plane = Some(RestingPlane {
            world_from_plane: Pose::from_translation(DVec3::Z * (0.5 * SIDE + 1e-3)),
            object_from_frame: Pose::identity(),
            on: None,
        });
        for handle in &object.handles {
            let handle = &mut problem.robot.handles[handle.at()];
            (handle.mask, handle.mask_complement) = ([true, true, true, false, true, true], [false; 6]);
            handle.mask_complement[3] = true;
        }
    }
    Ok(problem)
}
