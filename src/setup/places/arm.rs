//! Inverse kinematics of one gripper: damped least squares within bounds, from seeds.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::coordinate;
use foliate_components::Pose;
use foliate_components::pose::log_so3;
use foliate_components::robot::{JointIndex, JointType, Robot, Source};
use foliate_kernels::kinematics::Kinematics;
use glam::{DQuat, DVec3};

/// Most iterations from one seed.
const ITERATIONS: usize = 60;
/// Residual at which a pose is reached, metres and radians.
const REACHED: f64 = 1e-5;
/// Longest step of a joint, radians or metres.
const STEP: f64 = 0.4;
/// Damping, squared.
const DAMPING: f64 = 1e-5;

/// A gripper and the joints that move it.
pub(crate) struct Arm {
    /// The body that carries it.
    pub body: Option<JointIndex>,
    /// Its frame on that body.
    pub X_BG: Pose,
    /// By joint of the chain: the number of its coordinate, and the factor by which it follows it.
    chain: Vec<(JointIndex, usize, f64)>,
}

/// A pose that a gripper is to have: of a handle, with the rows that count.
#[derive(Clone, Copy)]
pub(crate) struct Target {
    pub X_WH: Pose,
    pub mask: [bool; 6],
    /// Whether the closing direction is to be level, beside what the mask says.
    pub is_level: bool,
}

impl Arm {
    /// The chain of the body that carries a frame.
    pub(crate) fn new(robot: &Robot, body: Option<JointIndex>, X_BG: Pose) -> Self {
        let above = std::iter::successors(body, |at| robot.joints[at.at()].parent);
        let entry = |joint: JointIndex| match robot.joints[joint.at()].source {
            Source::Coordinates { q, .. } => Some((joint, q, 1.0)),
            Source::Follows { leader, multiplier, .. } => Some((joint, coordinate(robot, leader)?, multiplier)),
        };
        Self { body, X_BG, chain: above.filter_map(entry).collect() }
    }

    /// Whether a joint moves the gripper.
    pub(crate) fn is_moved_by(&self, joint: JointIndex) -> bool {
        self.chain.iter().any(|(own, ..)| *own == joint)
    }

    /// The gripper in the world.
    pub(crate) fn gripper(&self, X_WJ: &[Pose]) -> Pose {
        self.body.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]) * self.X_BG
    }

    /// A configuration, from `q` on, at which the gripper is at the target; its poses are in `X_WJ` then.
    pub(crate) fn reach(
        &self,
        robot: &Robot,
        kinematics: &Kinematics,
        target: &Target,
        q: &mut [f64],
        X_WJ: &mut [Pose],
    ) -> bool {
        for _ in 0..ITERATIONS {
            kinematics.forward(q, X_WJ);
            let X_WG = self.gripper(X_WJ);
            let X_GH = X_WG.inverse() * target.X_WH;
            let turn = turn(X_GH.rotation, target.mask);
            let mut error = [0.0; 6];
            error[..3].copy_from_slice(&X_GH.translation.to_array());
            error[3..].copy_from_slice(&turn.to_array());
            error.iter_mut().zip(target.mask).filter(|(_, counts)| !counts).for_each(|(row, _)| *row = 0.0);
            let mut columns = self.columns(robot, X_WJ, &X_WG, if target.is_level { [true; 6] } else { target.mask });
            if target.is_level {
                error[3..].copy_from_slice(&level(&X_WG, &mut columns));
            }
            if error.iter().all(|row| row.abs() < REACHED) {
                return true;
            }
            let step = damped(&columns, &error);
            let longest = step.iter().fold(0.0_f64, |most, (_, x)| most.max(x.abs()));
            let scale = if longest > STEP { STEP / longest } else { 1.0 };
            for (at, x) in step {
                q[at] = (q[at] + x * scale).max(robot.space.lower[at]).min(robot.space.upper[at]);
            }
        }
        false
    }

    /// By coordinate: how it moves the gripper, in the gripper's axes.
    fn columns(&self, robot: &Robot, X_WJ: &[Pose], X_WG: &Pose, mask: [bool; 6]) -> Vec<(usize, [f64; 6])> {
        let mut columns: Vec<(usize, [f64; 6])> = Vec::with_capacity(self.chain.len());
        let into = X_WG.rotation.conjugate();
        for &(joint, at, factor) in &self.chain {
            let X_WB = X_WJ[joint.at()];
            let (linear, angular) = match robot.joints[joint.at()].motion {
                JointType::Revolute { axis } => {
                    let axis = X_WB.rotation * axis;
                    (axis.cross(X_WG.translation - X_WB.translation), axis)
                }
                JointType::Prismatic { axis } => (X_WB.rotation * axis, DVec3::ZERO),
                JointType::Planar => {
                    let plane = robot.joints[joint.at()].parent_from_joint.rotation;
                    let normal = plane * DVec3::Z;
                    let lever = X_WG.translation - X_WB.translation;
                    let moves = [
                        (plane * DVec3::X, DVec3::ZERO),
                        (plane * DVec3::Y, DVec3::ZERO),
                        (normal.cross(lever), normal),
                    ];
                    for (offset, (linear, angular)) in moves.into_iter().enumerate() {
                        columns.push((at + offset, column(into, linear, angular, mask)));
                    }
                    continue;
                }
                JointType::FreeFlyer => continue,
            };
            let column = column(into, linear * factor, angular * factor, mask);
            match columns.iter_mut().find(|(known, _)| *known == at) {
                Some((_, sum)) => sum.iter_mut().zip(column).for_each(|(sum, row)| *sum += row),
                None => columns.push((at, column)),
            }
        }
        columns
    }
}

/// The row that makes the closing direction level, in place of the rows of rotation.
fn level(X_WG: &Pose, columns: &mut [(usize, [f64; 6])]) -> [f64; 3] {
    let up = X_WG.rotation.conjugate() * DVec3::Z;
    let Some(about) = DVec3::new(up.z, 0.0, -up.x).try_normalize() else { return [0.0; 3] };
    for (_, column) in columns {
        let turned = about.dot(DVec3::new(column[3], column[4], column[5]));
        column[3..].copy_from_slice(&[turned, 0.0, 0.0]);
    }
    [-up.y / up.x.hypot(up.z), 0.0, 0.0]
}

/// How a gripper has to turn, in its own axes. Where the turn about one axis is free, that axis has to meet that of the handle: the rotation
/// vector would mix the rows the more, the farther the free turn goes.
fn turn(rotation: DQuat, mask: [bool; 6]) -> DVec3 {
    let free: Vec<usize> = (0..3).filter(|row| !mask[3 + row]).collect();
    let [row] = free[..] else { return log_so3(rotation) };
    let axis = DVec3::AXES[row];
    let there = rotation * axis;
    let about = axis.cross(there).try_normalize().unwrap_or(DVec3::AXES[(row + 1) % 3]);
    about * axis.angle_between(there)
}

/// A velocity in the axes that `into` leads to, its rows that do not count zero.
fn column(into: DQuat, linear: DVec3, angular: DVec3, mask: [bool; 6]) -> [f64; 6] {
    let mut column = [0.0; 6];
    column[..3].copy_from_slice(&(into * linear).to_array());
    column[3..].copy_from_slice(&(into * angular).to_array());
    column.iter_mut().zip(mask).filter(|(_, counts)| !counts).for_each(|(row, _)| *row = 0.0);
    column
}

/// Jᵀ(JJᵀ + λ)⁻¹e.
fn damped(columns: &[(usize, [f64; 6])], error: &[f64; 6]) -> Vec<(usize, f64)> {
    let mut matrix = [[0.0; 7]; 6];
    for (i, row) in matrix.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate().take(6) {
            *entry = columns.iter().map(|(_, column)| column[i] * column[j]).sum::<f64>();
        }
        row[i] += DAMPING;
        row[6] = error[i];
    }
    // Elimination without pivots: the matrix is positive definite.
    for i in 0..6 {
        for j in i + 1..6 {
            let factor = matrix[j][i] / matrix[i][i];
            let above = matrix[i];
            matrix[j].iter_mut().zip(above).skip(i).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    let mut y = [0.0; 6];
    for i in (0..6).rev() {
        let known: f64 = (i + 1..6).map(|k| matrix[i][k] * y[k]).sum();
        y[i] = (matrix[i][6] - known) / matrix[i][i];
    }
    columns.iter().map(|(at, column)| (*at, column.iter().zip(y).map(|(c, y)| c * y).sum())).collect()
}
