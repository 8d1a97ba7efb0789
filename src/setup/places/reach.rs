//! Where a gripper gets to: poses at random configurations, as seeds and as a map.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::coordinate;
use crate::setup::places::arm::Arm;
use crate::setup::places::world::World;
use crate::setup::solids::surface_points::PURPOSE;
use foliate_components::Pose;
use foliate_components::pose::log_so3;
use foliate_components::robot::{Joint, JointIndex};
use foliate_systems::runtime::random::stream;
use glam::{DMat3, DQuat, DVec3};

/// Random configurations.
const SAMPLES: u32 = 2000;
/// How often what touches in one of them is drawn anew.
const REPAIRS: u64 = 30;
/// Metres that a radian counts where seeds are compared.
const RADIAN: f64 = 0.15;
/// For each seed of what drives, so many samples are tried until one stands clear of the table.
const DRIVEN: usize = 12;

/// A gripper at a random configuration.
pub(crate) struct Reached {
    pub q: Vec<f64>,
    pub X_WG: Pose,
    /// Whether nothing collides there.
    pub is_free: bool,
}

impl Reached {
    /// Whether the gripper looks ahead or down, and not up.
    pub(crate) fn looks_down(&self) -> bool {
        (self.X_WG.rotation * DVec3::X).z < 0.2
    }
}

/// A gripper at random configurations of the joints that move it; a root that moves and all others stay as in `q`. What touches is drawn
/// anew a few times: arms that slide into each other are rarely free at random.
pub(crate) fn reached(world: &World, arm: &Arm, q: &[f64], seed: u64, number: usize) -> Vec<Reached> {
    let robot = &world.robot;
    let mut X_WJ = world.bodies();
    let mut drawn = q.to_vec();
    let single = |(number, joint): (usize, &Joint)| {
        let joint_index = JointIndex(number as u32);
        let is_drawn = joint.motion.configuration_size() == 1 && arm.is_moved_by(joint_index);
        coordinate(robot, joint_index).filter(|_| is_drawn)
    };
    let all: Vec<usize> = robot.joints.iter().enumerate().filter_map(single).collect();
    let sample = |index: u32| {
        let mut at = q.to_vec();
        let mut again = all.clone();
        let mut is_free = false;
        for repair in 0..=REPAIRS {
            let number = 2 + number as u64 + 1000 * repair;
            robot.space.random(&mut stream(seed, PURPOSE, number, index), &mut drawn);
            again.iter().for_each(|&i| at[i] = drawn[i]);
            world.kinematics.forward(&at, &mut X_WJ);
            let meeting = world.meeting(&X_WJ, None, 0.0);
            is_free = meeting.is_none();
            let Some(found) = meeting.filter(|_| repair < REPAIRS) else { break };
            again = world.between(found.bodies);
            again.retain(|i| all.contains(i));
        }
        Reached { X_WG: arm.gripper(&X_WJ), q: at, is_free }
    };
    (0..SAMPLES).map(sample).collect()
}

/// Configurations from which inverse kinematics is likely to lead to a pose, the best first: samples that are near by place and turn. What
/// drives stands where the sample comes nearest, clear of the table.
pub(crate) fn seeds(world: &World, arm: &Arm, reached: &[Reached], X_WG: &Pose, count: usize) -> Vec<Vec<f64>> {
    let Some(base) = arm.base(&world.robot) else {
        let approach = X_WG.rotation * DVec3::X;
        let far = |sample: &Reached| {
            let turn = (sample.X_WG.rotation * DVec3::X).angle_between(approach);
            sample.X_WG.translation.distance(X_WG.translation) + RADIAN * turn
        };
        return nearest(reached, far, count).into_iter().map(|sample| sample.q.clone()).collect();
    };
    let far = |sample: &Reached| {
        let left = X_WG.rotation * (driven(&sample.X_WG, X_WG).rotation * sample.X_WG.rotation).conjugate();
        (sample.X_WG.translation.z - X_WG.translation.z).abs() + RADIAN * log_so3(left).length()
    };
    let mut X_WJ = world.bodies();
    let mut stands = |sample: &Reached| {
        let q = moved(world, base, sample, &driven(&sample.X_WG, X_WG))?;
        world.kinematics.forward(&q, &mut X_WJ);
        world.is_beside_table(&X_WJ, arm.body).then_some(q)
    };
    nearest(reached, far, DRIVEN * count).into_iter().filter_map(&mut stands).take(count).collect()
}

/// The samples for which something is least, in that order; of those alone that are free, where some are.
fn nearest(reached: &[Reached], far: impl Fn(&Reached) -> f64, count: usize) -> Vec<&Reached> {
    let some_are_free = reached.iter().any(|sample| sample.is_free);
    let counts = |sample: &Reached| sample.is_free || !some_are_free;
    let mut ranked: Vec<(f64, usize)> =
        reached.iter().enumerate().filter(|(_, s)| counts(s)).map(|(at, sample)| (far(sample), at)).collect();
    let count = count.min(ranked.len());
    if count > 0 {
        ranked.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
    ranked.truncate(count);
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ranked.into_iter().map(|(_, at)| &reached[at]).collect()
}

/// The motion on the floor that brings one pose nearest to another: above the same place, with the turn about the vertical that leaves
/// the smallest one.
fn driven(from: &Pose, to: &Pose) -> Pose {
    let between = DMat3::from_quat(to.rotation * from.rotation.conjugate());
    let yaw = (between.x_axis.y - between.y_axis.x).atan2(between.x_axis.x + between.y_axis.y);
    let turn = DQuat::from_rotation_z(yaw);
    let mut by = to.translation - turn * from.translation;
    by.z = 0.0;
    Pose::from_parts(by, turn)
}

/// The configuration of a sample whose base was moved on the floor; none where that leads out of its bounds.
fn moved(world: &World, (joint, at): (JointIndex, usize), sample: &Reached, by: &Pose) -> Option<Vec<f64>> {
    let mut q = sample.q.clone();
    let X_WF = world.robot.joints[joint.at()].parent_from_joint;
    let X_FB = Pose::from_parts(DVec3::new(q[at], q[at + 1], 0.0), DQuat::from_rotation_z(q[at + 2]));
    let there = X_WF.inverse() * *by * X_WF * X_FB;
    let ahead = there.rotation * DVec3::X;
    q[at..at + 3].copy_from_slice(&[there.translation.x, there.translation.y, ahead.y.atan2(ahead.x)]);
    let space = &world.robot.space;
    let is_inside = |&at: &usize| space.lower[at] <= q[at] && q[at] <= space.upper[at];
    (at..at + 2).all(|at| is_inside(&at)).then_some(q)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_drives_comes_as_near_as_a_turn_on_the_floor_allows() {
        let from =
            Pose::from_parts(DVec3::new(0.3, -0.2, 0.9), DQuat::from_rotation_y(0.4) * DQuat::from_rotation_x(1.0));
        let floor = Pose::from_parts(DVec3::new(-1.2, 0.7, 0.0), DQuat::from_rotation_z(2.5));
        // Where the floor leads there exactly, it is found.
        let to = floor * from;
        let there = driven(&from, &to) * from;
        assert!(there.translation.distance(to.translation) < 1e-12);
        assert!(there.rotation.angle_between(to.rotation) < 1e-7);
        // Elsewhere no other turn leads nearer.
        let to = Pose::from_parts(DVec3::new(0.1, 0.2, 0.5), DQuat::from_rotation_x(0.3) * DQuat::from_rotation_y(1.1));
        let by = driven(&from, &to);
        let left = |turn: DQuat| (turn * from.rotation).angle_between(to.rotation);
        assert!((0..64).all(|i| left(by.rotation) <= left(DQuat::from_rotation_z(0.1 * f64::from(i))) + 1e-7));
        let there = by * from;
        assert!(there.translation.truncate().distance(to.translation.truncate()) < 1e-12);
        assert!((there.translation.z - from.translation.z).abs() < 1e-12);
    }
}
