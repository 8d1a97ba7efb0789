//! Where a gripper gets to: poses at random configurations, as seeds and as a map.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::coordinate;
use crate::setup::places::arm::Arm;
use crate::setup::places::world::World;
use crate::setup::solids::surface_points::PURPOSE;
use foliate_components::Pose;
use foliate_components::robot::{Joint, JointIndex};
use foliate_systems::runtime::random::stream;
use glam::DVec3;

/// Random configurations.
const SAMPLES: u32 = 2000;
/// How often what touches in one of them is drawn anew.
const REPAIRS: u64 = 6;
/// Metres that a radian counts where seeds are compared.
const RADIAN: f64 = 0.15;

/// A gripper at a random configuration.
pub(crate) struct Reached {
    pub q: Vec<f64>,
    pub X_WG: Pose,
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
        for repair in 0..=REPAIRS {
            let number = 2 + number as u64 + 1000 * repair;
            robot.space.random(&mut stream(seed, PURPOSE, number, index), &mut drawn);
            again.iter().for_each(|&i| at[i] = drawn[i]);
            world.kinematics.forward(&at, &mut X_WJ);
            let Some(found) = world.meeting(&X_WJ, None, 0.0).filter(|_| repair < REPAIRS) else { break };
            again = world.between(found.bodies);
            again.retain(|i| all.contains(i));
        }
        Reached { X_WG: arm.gripper(&X_WJ), q: at }
    };
    (0..SAMPLES).map(sample).collect()
}

/// The samples that are nearest to a pose, by place and approach, the nearest first.
pub(crate) fn seeds<'r>(reached: &'r [Reached], X_WG: &Pose, count: usize) -> Vec<&'r Reached> {
    let approach = X_WG.rotation * DVec3::X;
    let far = |sample: &Reached| {
        let turn = (sample.X_WG.rotation * DVec3::X).angle_between(approach);
        sample.X_WG.translation.distance(X_WG.translation) + RADIAN * turn
    };
    let mut ranked: Vec<(f64, usize)> = reached.iter().enumerate().map(|(at, sample)| (far(sample), at)).collect();
    let count = count.min(ranked.len());
    if count > 0 {
        ranked.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
    ranked.truncate(count);
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ranked.into_iter().map(|(_, at)| &reached[at]).collect()
}
