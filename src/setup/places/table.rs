//! Where a table stands, and how high the robot: where the gripper gets to most often.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::scene::assemble::parts::shape::ShapeSolid;
use crate::setup::grippers::is_beyond;
use crate::setup::places::arm::Arm;
use crate::setup::places::reach::Reached;
use crate::setup::solids::surface_points::{on_grid, triangles};
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, JointType, Robot};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// How high above the table the gripper counts, metres.
const BAND: (f64, f64) = (0.01, 0.25);
/// Between the robot and the edge of the table, metres.
const ROOM: f64 = 0.03;

/// Thickness of a table's top, metres.
pub(crate) const TOP: f64 = 0.04;

/// The size of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TableSize {
    /// Longer and shorter side of the top, metres.
    pub sides: (f64, f64),
    /// Height of the top, metres.
    pub height: f64,
}

/// Where a table stands beside a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Standing {
    /// The height of the robot's root link, metres.
    pub robot_height: f64,
    /// The middle of the top.
    pub X_WT: Pose,
    /// How many poses of the gripper are above it.
    pub count: usize,
}

impl Standing {
    /// Where a person wants it: x and y of the middle of the top and the yaw of its longer side, seen from the root of the robot.
    pub(crate) fn at([x, y, yaw]: [f64; 3], height: f64) -> Self {
        let X_WT = Pose::from_parts(DVec3::new(x, y, height), DQuat::from_rotation_z(yaw));
        Self { robot_height: 0.0, X_WT, count: 0 }
    }
}

/// The ways in which a table can stand, the best first: on each side of the robot, which stands on the floor or as high as the top.
pub(crate) fn standings(robot: &Robot, arms: &[Arm], reached: &[Vec<Reached>], size: &TableSize) -> Vec<Standing> {
    let mut found = Vec::new();
    for robot_height in [0.0, size.height] {
        for quarter in 0..4 {
            let yaw = FRAC_PI_2 * f64::from(quarter);
            let away = DVec3::new(yaw.cos(), yaw.sin(), 0.0);
            let near = edge(robot, arms, away, (size.height - robot_height, robot_height));
            let middle = away * (near + ROOM + size.sides.1 / 2.0) + DVec3::Z * size.height;
            // The longer side is across.
            let X_WT = Pose::from_parts(tidy(middle), DQuat::from_rotation_z(yaw + FRAC_PI_2));
            let above = |sample: &&Reached| {
                let p = X_WT.inverse_transform_point(sample.X_WG.translation + DVec3::Z * robot_height);
                let inside = p.x.abs() < size.sides.0 / 2.0 && p.y.abs() < size.sides.1 / 2.0;
                inside && (BAND.0..BAND.1).contains(&p.z) && sample.looks_down()
            };
            let count = reached.iter().flatten().filter(above).count();
            found.push(Standing { robot_height, X_WT, count });
        }
    }
    // A robot on the floor is worth as much as half of what a pedestal gains.
    let worth = |s: &Standing| if s.robot_height > 0.0 { s.count } else { 2 * s.count };
    found.sort_by_key(|standing| std::cmp::Reverse(worth(standing)));
    found.retain(|standing| standing.count > 0);
    found
}

fn tidy(v: DVec3) -> DVec3 {
    (v * 1e3).round() / 1e3
}

/// How far the robot reaches towards the table with what stays: bodies that no arm moves, and the first one of each arm. Heights are seen
/// from the robot's root.
fn edge(robot: &Robot, arms: &[Arm], away: DVec3, (top, _): (f64, f64)) -> f64 {
    let stays = |body: Option<JointIndex>| {
        let Some(body) = body else { return true };
        // A base that drives is as good as fixed.
        let chain = std::iter::successors(Some(body), |at| robot.joints[at.at()].parent);
        let depth = chain.filter(|at| robot.joints[at.at()].motion != JointType::Planar).count();
        let is_moved = arms.iter().any(|arm| {
            let above = std::iter::successors(arm.body, |at| robot.joints[at.at()].parent);
            above.into_iter().any(|at| at == body) || is_beyond(robot, Some(body), arm.body)
        });
        !is_moved || depth <= 1
    };
    let mut q = robot.space.neutral();
    robot.space.clamp(&mut q);
    let kinematics = foliate_kernels::kinematics::Kinematics::new(robot);
    let X_WJ = kinematics.poses(&q);
    let shapes = robot.shapes.iter().filter(|shape| stays(robot.links[shape.link.at()].joint));
    let points = shapes.flat_map(|shape| {
        let X_WB = robot.links[shape.link.at()].joint.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]);
        on_grid(&triangles(&shape.geometry, &(X_WB * shape.joint_from_shape)), 0.02)
    });
    let near = points.filter(|p| p.z > top - 0.1).map(|p| p.dot(away));
    near.fold(0.0, f64::max)
}

/// The solid of a table's top.
pub(crate) fn table_solid(size: &TableSize) -> ShapeSolid {
    ShapeSolid::Box { size: DVec3::new(size.sides.0, size.sides.1, TOP) }
}

/// The pose of the table's part: the middle of its top's solid.
pub(crate) fn table_pose(standing: &Standing) -> Pose {
    standing.X_WT * Pose::from_translation(-DVec3::Z * TOP / 2.0)
}
