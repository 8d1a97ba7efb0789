//! Sets of coordinates that may change apart from all others: limbs, and single joints. Fingers are in none: states say where they are.

use crate::planning_model::model::Model;
use bevy_ecs::prelude::Resource;
use foliate_components::robot::{JointIndex, JointType, PartKind, Robot, Source};
use std::collections::BTreeSet;

/// Sets of coordinates, each sorted. All are joints of one number that move robots.
#[derive(Clone, Debug, Default, PartialEq, Eq, Resource)]
pub struct Limbs {
    /// The joints that carry one gripper and no other; the joints of one robot, where there are several.
    pub limbs: Vec<Vec<usize>>,
    /// Single joints.
    pub joints: Vec<usize>,
}

impl Limbs {
    /// The limbs of a problem's robots.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        let robot = &model.problem.robot;
        let fingers: BTreeSet<usize> = {
            let hands = 0..model.problem.graph.hands.len() as u32;
            hands.flat_map(|hand| model.finger_coordinates(hand).collect::<Vec<_>>()).collect()
        };
        let joints = &moving_joints(robot) - &fingers;
        let chains: Vec<BTreeSet<usize>> =
            model.problem.graph.grippers.iter().map(|&gripper| chain(robot, gripper.at())).collect();
        let mut limbs = BTreeSet::new();
        for (index, own) in chains.iter().enumerate() {
            let others: BTreeSet<usize> = chains
                .iter()
                .enumerate()
                .filter(|(i, c)| *i != index && *c != own)
                .flat_map(|(_, c)| c.iter().copied())
                .collect();
            limbs.insert(own.difference(&others).copied().filter(|q| joints.contains(q)).collect::<Vec<_>>());
        }
        for part in robot.parts.iter().filter(|part| part.kind == PartKind::Robot) {
            let of_part =
                part.joints.clone().filter_map(|joint| coordinate(robot, joint)).filter(|q| !fingers.contains(q));
            limbs.insert(of_part.collect());
        }
        // All joints together are what a shortcut changes.
        let limbs = limbs.into_iter().filter(|limb| limb.len() > 1 && limb.len() < joints.len()).collect();
        Self { limbs, joints: joints.into_iter().collect() }
    }
}

/// Coordinates of all joints of one number of robots that can move.
fn moving_joints(robot: &Robot) -> BTreeSet<usize> {
    let parts = robot.parts.iter().filter(|part| part.kind == PartKind::Robot);
    let joints = parts.flat_map(|part| part.joints.clone());
    joints.filter_map(|joint| coordinate(robot, joint)).collect()
}

/// The coordinate of a joint of one number, where it has one of its own and can move.
fn coordinate(robot: &Robot, joint: usize) -> Option<usize> {
    let joint = &robot.joints[joint];
    let Source::Coordinates { q, .. } = joint.source else { return None };
    let is_single = matches!(joint.motion, JointType::Revolute { .. } | JointType::Prismatic { .. });
    (is_single && !robot.space.is_immovable(q..q + 1)).then_some(q)
}

/// Coordinates of the joints that carry a gripper.
fn chain(robot: &Robot, gripper: usize) -> BTreeSet<usize> {
    let mut chain = BTreeSet::new();
    let mut next: Option<JointIndex> = robot.links[robot.grippers[gripper].link.at()].joint;
    while let Some(joint) = next {
        chain.extend(coordinate(robot, joint.at()));
        next = robot.joints[joint.at()].parent;
    }
    chain
}
