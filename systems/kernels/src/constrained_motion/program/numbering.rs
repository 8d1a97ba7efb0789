//! Numbers of variables, rows and decoded parameters in a program, and the joints that a block refers to.
//!
//! The functions work on blocks and the robot alone, without the state of the compiler.

use crate::constrained_motion::rows::blocks::{Block, Kind};
use crate::kinematics::joint_table::JointCoordinates;
use foliate_components::constraint::{Constraint, Frame, Masses, RelativePose};
use foliate_components::robot::{JointIndex, Robot};

/// The body that a constraint puts in its place in the world, with what says so.
pub(crate) fn foot_of(constraint: &Constraint) -> Option<(RelativePose, JointIndex)> {
    let Constraint::RelativePose(pose) = constraint else { return None };
    match (pose.a.joint, pose.b.joint) {
        (None, Some(foot)) | (Some(foot), None) if pose.is_rigid() => Some((*pose, foot)),
        _ => None,
    }
}

/// The velocity coordinates that move a joint: its own, or its leader's.
pub(crate) fn velocities_of(robot: &Robot, joint: JointIndex) -> std::ops::Range<usize> {
    let joint = &robot.joints[joint.at()];
    let v = JointCoordinates::of(robot, joint).v;
    v..v + joint.motion.velocity_size()
}

/// Numbers the velocity coordinates that columns use from zero, ascending; returns them.
pub(crate) fn compress(blocks: &mut [Block], dimension: usize) -> Vec<usize> {
    let mut used = vec![false; dimension];
    for column in blocks.iter_mut().flat_map(Block::columns_mut) {
        used[column.variable()] = true;
    }
    let active: Vec<usize> = (0..dimension).filter(|&v| used[v]).collect();
    for column in blocks.iter_mut().flat_map(Block::columns_mut) {
        let variable = column.variable_mut();
        // Every used coordinate is in the list.
        *variable = active.partition_point(|&v| v < *variable);
    }
    active
}

pub(crate) fn number_rows(blocks: &mut [Block]) -> usize {
    let mut rows = 0;
    for block in blocks {
        block.first = rows;
        rows += block.rows;
    }
    rows
}

pub(crate) fn number_decoded<'a>(blocks: impl Iterator<Item = &'a mut Block>) -> usize {
    let mut count = 0;
    for block in blocks {
        if let Kind::Contact(contact) = &mut block.kind
            && contact.part.slot().is_some()
        {
            contact.decoded = count;
            count += 1;
        }
    }
    count
}

pub(crate) fn joints_of(block: &Block) -> Vec<JointIndex> {
    match &block.kind {
        Kind::Pose(pose) => [pose.a.joint, pose.b.joint].into_iter().flatten().collect(),
        Kind::Contact(contact) => {
            let polygons = contact.placement.object.iter().chain(&contact.placement.supports);
            polygons.filter_map(|polygon| polygon.frame.joint).collect()
        }
        Kind::Balance { balance, .. } => with_masses(&balance.masses, [&balance.frame]),
        Kind::BalanceBetween { balance, .. } => with_masses(&balance.masses, [&balance.first, &balance.second]),
        Kind::Distance { distance, .. } => [distance.a.joint, distance.b.joint].into_iter().flatten().collect(),
        Kind::Custom(function) => function.frames().iter().filter_map(|frame| frame.joint).collect(),
        Kind::Locked { .. } => Vec::new(),
    }
}

fn with_masses<'a>(masses: &Masses, frames: impl IntoIterator<Item = &'a Frame>) -> Vec<JointIndex> {
    let heavy = masses.bodies().iter().filter_map(|heavy| heavy.body);
    heavy.chain(frames.into_iter().filter_map(|frame| frame.joint)).collect()
}
