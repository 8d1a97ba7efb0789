//! A proof that an object that starts in a hand stays in hands: no state that can be reached has it lie anywhere.
//!
//! States in which an object would have to lie on supports that are too small for it have no configuration.

use crate::goals::demands::{RESTS, may_hold};
use crate::goals::impossible::moves::{own_grasps, with_object_at};
use crate::planning_model::graph::connected_states::connected_states;
use crate::planning_model::graph::support_placement::SupportPlacement;
use crate::planning_model::model::Model;
use crate::planning_model::state_classification::Feasible;
use foliate_components::graph::{ConstraintKind, State, StateId};
use foliate_components::infeasibility::Infeasibility;
use foliate_components::problem::{Goal, OtherHands, PartialGoal};
use foliate_components::robot::JointIndex;

/// The reason why no goal can be reached, where each wants an object out of the hands in which it stays.
pub(crate) fn never_put_down(model: &Model, start: &Feasible) -> Option<Infeasibility> {
    let (graph, robot) = (&model.graph, &model.problem.robot);
    let of_start = graph.state(start.state);
    let is_possible = |state: &State| state == of_start || all_may_rest(model, state);
    let is_connected = connected_states(graph, start.state, is_possible);
    let reached: Vec<StateId> =
        (0u32..).map(StateId).zip(is_connected).filter_map(|(s, is_in)| is_in.then_some(s)).collect();
    let unwanted = |object: usize| {
        let part = graph.objects[object].part;
        let own = |&state: &StateId| own_grasps(graph, graph.state(state), object);
        let is_kept = reached.iter().all(|state| own(state).next().is_some());
        let is_unwanted = |goal: &PartialGoal| {
            goal.lying.iter().any(|(lying, _)| *lying == part)
                || lies_there(model, goal, start, object)
                || reached.iter().all(|state| own(state).any(|grasp| !may_hold(model, goal, grasp)))
        };
        let in_every_goal = |goal: &Goal| match goal {
            Goal::Partial(goal) => is_unwanted(goal),
            Goal::Configuration(_) => false,
        };
        is_kept && !model.problem.goals.is_empty() && model.problem.goals.iter().all(in_every_goal)
    };
    let object = (0..graph.objects.len()).find(|&object| unwanted(object))?;
    let (gripper, _) = own_grasps(graph, of_start, object).next()?;
    let resting = &model.objects()[object].resting;
    let too_small = resting.iter().filter(|place| !may_rest(&place.resting)).flat_map(|place| &place.supports);
    Some(Infeasibility::NeverPutDown {
        object: robot.parts[graph.objects[object].part.at()].name.clone(),
        gripper: robot.grippers[gripper.at()].name.clone(),
        too_small: too_small.map(|support| robot.surfaces[support.at()].name.clone()).collect(),
    })
}

/// Whether a goal has an object at a pose at which it lies on what is fixed in the world, and says nothing of a hand around it: then none is.
fn lies_there(model: &Model, goal: &PartialGoal, start: &Feasible, object: usize) -> bool {
    let part = model.graph.objects[object].part;
    let is_asked = goal.held.contains(&part) || !goal.hands.is_empty() || goal.other_hands == OtherHands::Anything;
    let pose = goal.poses.iter().find(|(named, _)| *named == part).filter(|_| !is_asked);
    let there = pose.and_then(|(_, pose)| with_object_at(model, &start.q, object, pose));
    there.is_some_and(|q| {
        let X_WJ = model.kinematics.poses(&q);
        let fixed = model.objects()[object].resting.iter().filter(|place| place.on.is_none());
        fixed.map(|place| place.resting.residual(0.0, &X_WJ)).any(|off| off <= RESTS)
    })
}

/// Whether the supports of a state are large enough for what lies on them.
fn all_may_rest(model: &Model, state: &State) -> bool {
    let on = |object: u32, on: Option<JointIndex>| model.objects().get(object as usize)?.placement_on(on);
    state.manifold.iter().all(|&constraint| match model.graph.constraint(constraint).kind {
        ConstraintKind::Placement { object, on: body } => on(object, body).is_none_or(|place| may_rest(&place.resting)),
        _ => true,
    })
}

fn may_rest(resting: &SupportPlacement) -> bool {
    match resting {
        SupportPlacement::Surfaces(lying) => lying.may_rest(),
        SupportPlacement::Plane { .. } => true,
    }
}
