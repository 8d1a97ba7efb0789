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
/// Residual that is as good as none.
const EXACT: f64 = 1e-9;
/// Longest step of a joint, radians or metres.
const STEP: f64 = 0.4;
/// Damping, squared.
const DAMPING: f64 = 1e-5;
/// A floor is level where its normal has at least this height.
const LEVEL: f64 = 0.9999;

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

    /// The joint by which what carries the arm drives on a level floor, and the number of its first coordinate.
    pub(crate) fn base(&self, robot: &Robot) -> Option<(JointIndex, usize)> {
        let &(joint, at, _) = self.chain.last()?;
        let record = &robot.joints[joint.at()];
        let is_level = (record.parent_from_joint.rotation * DVec3::Z).z > LEVEL;
        (record.motion == JointType::Planar && record.parent.is_none() && is_level).then_some((joint, at))
    }

    /// Whether a coordinate is one of the base.
    pub(crate) fn drives_by(&self, robot: &Robot, at: usize) -> bool {
        self.base(robot).is_some_and(|(_, first)| (first..first + 3).contains(&at))
    }

    /// How many coordinates move it.
    pub(crate) fn coordinates(&self, robot: &Robot) -> usize {
        let mut sizes: Vec<(usize, usize)> = Vec::new();
        for &(joint, at, _) in &self.chain {
            if sizes.iter().all(|(known, _)| *known != at) {
                sizes.push((at, robot.joints[joint.at()].motion.velocity_size()));
            }
        }
        sizes.iter().map(|(_, size)| size).sum()
    }

    /// The gripper in the world.
    pub(crate) fn gripper(&self, X_WJ: &[Pose]) -> Pose {
        self.body.map_or(Pose::IDENTITY, |body| X_WJ[body.at()]) * self.X_BG
    }

    /// A configuration, from `q` on, at which the gripper is at the target; its poses are in `X_WJ` then. Coordinates that are held stay.
    pub(crate) fn reach(
        &self,
        robot: &Robot,
        kinematics: &Kinematics,
        target: &Target,
        (q, held): (&mut [f64], &[usize]),
        X_WJ: &mut [Pose],
    ) -> bool {
        self.approach(robot, kinematics, target, (q, held), X_WJ, REACHED) < REACHED
    }

    /// How closely the gripper gets to a target from where it has reached it: the largest row that is left, metres and radians.
    pub(crate) fn residual(
        &self,
        robot: &Robot,
        kinematics: &Kinematics,
        target: &Target,
        (q, held): (&mut [f64], &[usize]),
        X_WJ: &mut [Pose],
    ) -> f64 {
        self.approach(robot, kinematics, target, (q, held), X_WJ, EXACT)
    }

    /// Steps towards a target until no row is larger than `until`. The largest row at the end.
    fn approach(
        &self,
        robot: &Robot,
        kinematics: &Kinematics,
        target: &Target,
        (q, held): (&mut [f64], &[usize]),
        X_WJ: &mut [Pose],
        until: f64,
    ) -> f64 {
        let mut largest = f64::INFINITY;
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
            columns.retain(|(at, _)| !held.contains(at));
            if target.is_level {
                error[3..].copy_from_slice(&level(&X_WG, &mut columns));
            }
            largest = error.iter().fold(0.0, |most: f64, row| most.max(row.abs()));
            if largest < until {
                return largest;
            }
            let step = inside(robot, &mut columns, &error, q);
            if step.is_empty() {
                return largest;
            }
            let longest = step.iter().fold(0.0_f64, |most, (_, x)| most.max(x.abs()));
            let scale = if longest > STEP { STEP / longest } else { 1.0 };
            for (at, x) in step {
                q[at] = (q[at] + x * scale).max(robot.space.lower[at]).min(robot.space.upper[at]);
            }
        }
        largest
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

/// The step of the joints that are not at a bound beyond which the step would lead: what such a joint cannot give the others have to.
fn inside(robot: &Robot, columns: &mut Vec<(usize, [f64; 6])>, error: &[f64; 6], q: &[f64]) -> Vec<(usize, f64)> {
    loop {
        let step = damped(columns, error);
        let is_beyond = |&(at, x): &(usize, f64)| {
            (x > 0.0 && q[at] >= robot.space.upper[at]) || (x < 0.0 && q[at] <= robot.space.lower[at])
        };
        let stuck: Vec<usize> = step.iter().filter(|entry| is_beyond(entry)).map(|(at, _)| *at).collect();
        if stuck.is_empty() {
            return step;
        }
        columns.retain(|(at, _)| !stuck.contains(at));
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::robot::model::{JointKind, JointModel, LinkModel, Model};
    use foliate_components::samples::models::fixed_robot;

    #[test]
    fn joints_at_their_bounds_leave_the_way_to_the_others() {
        // Eight sliders in a row, all but the last at the end of their ranges.
        let link = |number: usize| LinkModel { name: format!("l{number}"), shapes: Vec::new(), inertial: None };
        let slider = |parent: usize| JointModel {
            name: format!("j{parent}"),
            kind: JointKind::Prismatic,
            parent,
            child: parent + 1,
            parent_from_joint: Pose::identity(),
            axis: DVec3::X,
            limits: (0.0, 0.1),
            velocity_limit: None,
            mimic: None,
        };
        let model =
            Model { links: (0..9).map(link).collect(), joints: (0..8).map(slider).collect(), ..Model::default() };
        let robot = Robot::compose(&[(&model, fixed_robot("arm", Pose::identity()))]).unwrap();
        let kinematics = Kinematics::new(&robot);
        let arm = Arm::new(&robot, Some(JointIndex(7)), Pose::identity());
        let target = |x: f64| Target { X_WH: Pose::from_translation(DVec3::X * x), mask: [true; 6], is_level: false };
        let mut q = [0.1; 8];
        q[7] = 0.0;
        let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
        assert!(arm.reach(&robot, &kinematics, &target(0.75), (&mut q, &[]), &mut X_WJ));
        assert!((q[7] - 0.05).abs() < 1e-4 && q[..7].iter().all(|x| (x - 0.1).abs() < 1e-12), "{q:?}");
        assert!(!arm.reach(&robot, &kinematics, &target(0.85), (&mut q, &[]), &mut X_WJ));
        // What is held stays.
        assert!(arm.reach(&robot, &kinematics, &target(0.7), (&mut q, &[7]), &mut X_WJ));
        assert!((q[7] - 0.1).abs() < 1e-12, "{q:?}");
    }
}
