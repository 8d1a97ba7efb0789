//! Grasps in which the hand overlaps the object, wherever the arm is: the object is wider than the hand opens, or the palm is in it.

use crate::goals::impossible::moves::with_object_at;
use crate::planning_model::graph::attachment_order::{is_beyond, solid_grasp};
use crate::planning_model::model::Model;
use crate::settings::SearchSettings;
use foliate_components::constraint::{Grasp, Mask};
use foliate_components::graph::StateId;
use foliate_components::infeasibility::RuledOut;
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, ShapeIndex, Source};

/// Overlapping by less is left to the search, metres.
const DEEP: f64 = 1e-4;

/// The shapes of hand and object that overlap where the gripper holds the handle with its fingers as the grasp has them. Nothing is said of
/// grasps that leave a row free.
pub(super) fn hand_in_object(
    model: &Model,
    settings: &SearchSettings,
    start: &[f64],
    (gripper, handle): (GripperIndex, HandleIndex),
    object: usize,
) -> Option<RuledOut> {
    let robot = &model.problem.robot;
    let grasp = Grasp::new(robot, gripper, handle).ok()?;
    if grasp.mask != Mask([true; 6]) || grasp.handle.joint != model.objects()[object].root {
        return None;
    }
    let holding = (0u32..).map(StateId).zip(&model.graph.states);
    let (state, _) = holding
        .filter(|(_, state)| !state.is_passed_through() && state.grasps.contains(&(gripper, handle)))
        .min_by_key(|(_, state)| state.grasps.len())?;
    let mut q = start.to_vec();
    model.rest(state, &mut q);
    let (hand, hand_from_object) = solid_grasp(&grasp);
    let X_WH = hand.map_or_else(Default::default, |hand| model.kinematics.poses(&q)[hand.at()]);
    let q = with_object_at(model, &q, object, &(X_WH * hand_from_object))?;
    let X_WJ = model.kinematics.poses(&q);
    let body_of = |shape: ShapeIndex| robot.links[robot.shapes[shape.at()].link.at()].joint;
    let is_of_hand = |shape: ShapeIndex| moves_with(model, gripper, body_of(shape), hand);
    let is_of_object = |shape: ShapeIndex| body_of(shape) == grasp.handle.joint;
    let contacts = model.all_collisions(state, &X_WJ, settings.clearance_guard);
    let overlaps = contacts.iter().filter_map(|contact| {
        let (a, b) = model.pair_shapes(contact.pair);
        let (of_hand, of_object) = if is_of_object(a) { (b, a) } else { (a, b) };
        let depth = model.overlap(contact.pair, &X_WJ).filter(|_| is_of_hand(of_hand) && is_of_object(of_object))?;
        (depth > DEEP).then_some((depth, of_hand, of_object))
    });
    let (depth, of_hand, of_object) = overlaps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let name = |shape: ShapeIndex| robot.shapes[shape.at()].name.clone();
    Some(RuledOut::HandInObject { shapes: (name(of_hand), name(of_object)), depth })
}

/// Whether a body is that of a gripper, or hangs on it by nothing but fingers of the gripper's hand, which stand still in a grasp.
fn moves_with(model: &Model, gripper: GripperIndex, body: Option<JointIndex>, hand: Option<JointIndex>) -> bool {
    if body == hand {
        return true;
    }
    let (robot, Some(hand)) = (&model.problem.robot, hand) else { return false };
    let fingers: Vec<JointIndex> = model
        .problem
        .graph
        .hands
        .iter()
        .filter(|candidate| candidate.grippers.contains(&gripper))
        .flat_map(|hand| hand.fingers.iter().map(|finger| finger.joint))
        .collect();
    let stands = |joint: JointIndex| match robot.joints[joint.at()].source {
        Source::Coordinates { q, .. } => {
            fingers.contains(&joint) || model.locked.iter().any(|&(locked, _)| locked == q)
        }
        Source::Follows { .. } => false,
    };
    let is_finger = |joint: JointIndex| match robot.joints[joint.at()].source {
        Source::Follows { leader, .. } => stands(leader),
        Source::Coordinates { .. } => stands(joint),
    };
    is_beyond(robot, body, hand)
        && std::iter::successors(body, |joint| robot.joints[joint.at()].parent)
            .take_while(|&joint| joint != hand)
            .all(is_finger)
}
