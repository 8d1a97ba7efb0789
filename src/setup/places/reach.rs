//! Where a gripper gets to: poses at random configurations, as seeds and as a map.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::places::arm::Arm;
use crate::setup::places::world::World;
use crate::setup::solids::surface_points::PURPOSE;
use foliate_components::Pose;
use foliate_components::robot::JointIndex;
use foliate_systems::runtime::random::stream;
use glam::DVec3;

/// Random configurations.
const SAMPLES: u32 = 3000;
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

/// A gripper at random configurations of the joints that move it; a root that moves and all others stay as in `q`.
pub(crate) fn reached(world: &World, arm: &Arm, q: &[f64], seed: u64, number: usize) -> Vec<Reached> {
    let robot = &world.robot;
    let mut X_WJ = world.bodies();
    let mut drawn = q.to_vec();
    let sample = |index: u32| {
        robot.space.random(&mut stream(seed, PURPOSE, 2 + number as u64, index), &mut drawn);
        let mut at = q.to_vec();
        for (number, joint) in robot.joints.iter().enumerate() {
            if let Some(first) = crate::setup::grippers::coordinate(robot, JointIndex(number as u32))
                && joint.motion.configuration_size() == 1
                && arm.is_moved_by(JointIndex(number as u32))
            {
                at[first] = drawn[first];
            }
        }
        world.kinematics.forward(&at, &mut X_WJ);
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
