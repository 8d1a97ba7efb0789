//! What a goal asks of hands, supports and numbers besides rows of constraints: which states fit it, and which configurations.
//!
//! Nothing is left in a hand that the goal does not ask for.

use crate::planning_model::graph::support_placement::PlacementOnSupport;
use crate::planning_model::model::Model;
use foliate_components::Pose;
use foliate_components::constraint::Constraint;
use foliate_components::graph::{ConstraintKind, StateId};
use foliate_components::problem::{GraphOptions, Holding, JointRest, OtherHands, PartialGoal};
use foliate_components::robot::configuration::wrap;
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, PartIndex, PartKind, Source, SurfaceIndex};
use foliate_kernels::constraints;

/// Off its support by less than this an object rests on it, metres and radians.
pub(crate) const RESTS: f64 = 1e-4;

/// Refuses a state in which a hand holds what the goal does not ask for, or in which something does not lie or is not held that it asks
/// for.
///
/// # Errors
/// What is wrong with the state.
pub(crate) fn fit(model: &Model, goal: &PartialGoal, state: StateId) -> Result<(), String> {
    let robot = &model.problem.robot;
    let grasps = grasps(model, state);
    for &(gripper, handle) in &grasps {
        let (hand, held) = (&robot.grippers[gripper.at()].name, &robot.handles[handle.at()].name);
        if !may_hold(model, goal, (gripper, handle)) {
            return Err(format!("{hand} holds {held}, which the goal does not ask for"));
        }
    }
    for &(gripper, holding) in &goal.hands {
        let holds = |fits: &dyn Fn(HandleIndex) -> bool| grasps.iter().any(|&(g, h)| g == gripper && fits(h));
        let hand = &robot.grippers[gripper.at()].name;
        let missing = match holding {
            Holding::Nothing | Holding::Anything => None,
            Holding::Object(part) => {
                (!holds(&|handle| object_of(model, handle) == part)).then(|| robot[part].name.clone())
            }
            Holding::Handle(wanted) => {
                (!holds(&|handle| handle == wanted)).then(|| robot.handles[wanted.at()].name.clone())
            }
        };
        if let Some(missing) = missing {
            return Err(format!("{hand} does not hold {missing}"));
        }
    }
    if let Some(part) = goal.held.iter().find(|&&part| grasps.iter().all(|&(_, h)| object_of(model, h) != part)) {
        return Err(format!("nothing holds {}", robot[*part].name));
    }
    match goal.lying.iter().find(|(part, supports)| !may_lie(model, state, *part, supports)) {
        Some((part, _)) => Err(format!("{} does not lie where the goal wants it", robot[*part].name)),
        None => Ok(()),
    }
}

/// Whether a goal lets a gripper hold a handle in the end.
pub(crate) fn may_hold(model: &Model, goal: &PartialGoal, (gripper, handle): (GripperIndex, HandleIndex)) -> bool {
    let asked = goal.hands.iter().find(|(named, _)| *named == gripper).map(|&(_, holding)| holding);
    let object = object_of(model, handle);
    match asked {
        Some(Holding::Nothing) => false,
        Some(Holding::Anything) => true,
        Some(Holding::Object(part)) => part == object,
        Some(Holding::Handle(wanted)) => wanted == handle,
        None => is_free(model, goal, gripper) || goal.held.contains(&object) || is_about(model, goal, object),
    }
}

/// Whether a configuration that fits the rows of a goal, in a state that fits it, also has what is near near, what lies on the supports
/// that are named, and no hand around what rests without it.
pub(crate) fn are_met(model: &Model, goal: &PartialGoal, state: StateId, q: &[f64]) -> bool {
    let near = |&(index, value, tolerance): &(usize, f64, f64)| off(model, index, q[index] - value) <= tolerance + 1e-9;
    if !goal.near.iter().all(near) {
        return false;
    }
    let X_WJ = model.kinematics.poses(q);
    let lies = |(part, _): &(PartIndex, Vec<SurfaceIndex>)| {
        placements(model, state, *part).any(|(object, place)| {
            let rows = lying_rows(model, goal, object, place.on);
            rows.is_some_and(|rows| constraints::residual(&model.problem.robot, &rows, q, &X_WJ) <= RESTS)
        })
    };
    goal.lying.iter().all(lies) && are_needed(model, goal, state, q, &X_WJ)
}

/// How far a number is from where it should be; full turns of an angle without limits make no difference.
fn off(model: &Model, index: usize, off: f64) -> f64 {
    let space = &model.problem.robot.space;
    let endless = !space.lower[index].is_finite() && !space.upper[index].is_finite();
    if endless { wrap(off).abs() } else { off.abs() }
}

/// On what an object lies in a state, with its number in the graph.
fn placements(model: &Model, state: StateId, part: PartIndex) -> impl Iterator<Item = (u32, &PlacementOnSupport)> {
    model.graph.state(state).manifold.iter().filter_map(move |&constraint| {
        let ConstraintKind::Placement { object, on } = model.graph.constraint(constraint).kind else { return None };
        let is_it = model.graph.objects[object as usize].part == part;
        let place = model.objects()[object as usize].placement_on(on).filter(|_| is_it)?;
        Some((object, place))
    })
}

/// What an object that lies on a body has to hold: that it lies there, and on one of the supports that the goal names.
pub(crate) fn lying_rows(model: &Model, goal: &PartialGoal, object: u32, on: Option<JointIndex>) -> Option<Constraint> {
    let options = &model.graph.objects[object as usize];
    let Some((_, supports)) = goal.lying.iter().find(|(part, _)| *part == options.part) else {
        return Some(model.objects()[object as usize].placement_on(on)?.resting.constraint(0.0));
    };
    let problem = &model.problem;
    let only = GraphOptions { supports: supports.clone(), ..problem.graph.clone() };
    let places = PlacementOnSupport::of_object(&problem.robot, &only, options).ok()?;
    Some(places.iter().find(|place| place.on == on)?.resting.constraint(0.0))
}

/// Whether no hand is left around what rests without it: of objects that may be held because the goal gives them a place.
fn are_needed(model: &Model, goal: &PartialGoal, state: StateId, q: &[f64], X_WJ: &[Pose]) -> bool {
    grasps(model, state).into_iter().all(|(gripper, handle)| {
        let object = object_of(model, handle);
        let is_asked = goal.hands.iter().any(|(named, _)| *named == gripper) || goal.held.contains(&object);
        is_asked || is_free(model, goal, gripper) || !rests(model, object, q, X_WJ)
    })
}

/// Whether anything may be in a gripper: it is no robot's, or the goal says so.
fn is_free(model: &Model, goal: &PartialGoal, gripper: GripperIndex) -> bool {
    let robot = &model.problem.robot;
    let part = robot.links[robot.grippers[gripper.at()].link.at()].part;
    robot[part].kind != PartKind::Robot || goal.other_hands == OtherHands::Anything
}

fn grasps(model: &Model, state: StateId) -> Vec<(GripperIndex, HandleIndex)> {
    let kinds = model.graph.state(state).manifold.iter().map(|&constraint| model.graph.constraint(constraint).kind);
    let grasp = |kind| match kind {
        ConstraintKind::Grasp { gripper, handle } => Some((gripper, handle)),
        _ => None,
    };
    kinds.filter_map(grasp).collect()
}

fn object_of(model: &Model, handle: HandleIndex) -> PartIndex {
    let robot = &model.problem.robot;
    robot.links[robot.handles[handle.at()].link.at()].part
}

/// Whether a goal gives an object a place.
fn is_about(model: &Model, goal: &PartialGoal, part: PartIndex) -> bool {
    let robot = &model.problem.robot;
    let is_of_part = |joint: JointIndex| robot.joints[joint.at()].part == part;
    let owner = |index: usize| {
        let has = |joint: &foliate_components::robot::Joint| match joint.source {
            Source::Coordinates { q, .. } => (q..q + joint.motion.configuration_size()).contains(&index),
            Source::Follows { .. } => false,
        };
        robot.joints.iter().any(|joint| joint.part == part && has(joint))
    };
    goal.poses.iter().any(|(named, _)| *named == part)
        || goal.coordinates.iter().any(|&(index, _)| owner(index))
        || goal.near.iter().any(|&(index, ..)| owner(index))
        || goal.constraints.iter().any(|named| named.constraint.bodies().into_iter().flatten().any(is_of_part))
}

/// Whether an object may lie on one of these supports in a state.
fn may_lie(model: &Model, state: StateId, part: PartIndex, supports: &[SurfaceIndex]) -> bool {
    placements(model, state, part).any(|(_, place)| supports.iter().any(|support| place.supports.contains(support)))
}

/// Whether an object rests without a hand where it is.
fn rests(model: &Model, part: PartIndex, q: &[f64], X_WJ: &[Pose]) -> bool {
    let Some(object) = model.graph.objects.iter().position(|object| object.part == part) else { return false };
    let object = &model.objects()[object];
    if object.root.is_some() {
        return object.resting.is_empty() || object.resting.iter().any(|at| at.resting.residual(0.0, X_WJ) <= RESTS);
    }
    // A door or drawer that has to be elsewhere while nothing holds it is held where the goal wants it.
    let joints = &model.problem.robot.joints;
    model.problem.graph.resting_joints.iter().all(|resting| {
        let JointRest::At(value) = resting.rest else { return true };
        let Source::Coordinates { q: at, .. } = joints[resting.joint.at()].source else { return true };
        joints[resting.joint.at()].part != part || (q[at] - value).abs() <= RESTS
    })
}
