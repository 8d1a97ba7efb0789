//! Proofs that no goal can be reached, before anything is searched. Nothing is said of lazy graphs, whose states are not known.
//!
//! Each leg of a transition keeps the values of its leaf. So a constraint that foliates every state that a path may pass keeps its value
//! along the path: an object whose placement in the world is such a constraint stays where it starts. And where an object stands in the
//! world in all states in which it is not held, the first grasp of it is made where it starts, and the last one where the goal has it.

use crate::goals::impossible::arm_length;
use crate::goals::impossible::hand_fit;
use crate::goals::impossible::moves::{
    Asked, asked, displacement, grasps_of, moves_in_hands_alone, objects_to_move, own_grasps, stands_in_world,
};
use crate::goals::impossible::put_down::never_put_down;
use crate::planning_model::graph::connected_states::connected_states;
use crate::planning_model::model::Model;
use crate::planning_model::state_classification::Feasible;
use crate::settings::SearchSettings;
use foliate_components::graph::StateId;
use foliate_components::infeasibility::{ImpossibleGrasp, Infeasibility, ObjectPlace};
use foliate_components::problem::Goal;

/// The reason why no goal can be reached, where every goal moves an object that nothing moves, or that no hand can hold where it starts or
/// where the goals have it.
pub(crate) fn refute(model: &Model, settings: &SearchSettings, start: &Feasible) -> Option<Infeasibility> {
    if model.graph.lazy || model.problem.goals.is_empty() {
        return None;
    }
    let is_connected = connected_states(&model.graph, start.state, |_| true);
    never_moves(model, start, &is_connected)
        .or_else(|| never_put_down(model, start))
        .or_else(|| no_grasp_is_possible(model, settings, start))
}

fn never_moves(model: &Model, start: &Feasible, is_connected: &[bool]) -> Option<Infeasibility> {
    let fixed: Vec<usize> =
        (0..model.objects().len()).filter(|&object| stays(model, start, object, is_connected)).collect();
    let reason = |goal| fixed.iter().find_map(|&object| contradiction(model, &start.q, goal, object));
    let mut reasons = model.problem.goals.iter().map(reason);
    let first = reasons.next()??;
    reasons.all(|reason| reason.is_some()).then_some(first)
}

/// Whether an object stands in the world in the start, and in each of these states.
fn stays(model: &Model, start: &Feasible, object: usize, states: &[bool]) -> bool {
    let graph = &model.graph;
    let of_start = graph.state(start.state).foliation.iter().zip(&start.parameters);
    let is_own = |constraint| stands_in_world(graph.constraint(constraint).kind, object);
    let mut in_world = of_start.filter(|(constraint, value)| value.carrier.is_none() && is_own(**constraint));
    let all = || (0u32..).map(StateId).zip(states).filter(|(_, is_in)| **is_in).map(|(state, _)| state);
    in_world.any(|(constraint, _)| all().all(|state| graph.state(state).foliation.contains(constraint)))
}

fn contradiction(model: &Model, start: &[f64], goal: &Goal, object: usize) -> Option<Infeasibility> {
    let (distance, angle) = displacement(model, start, goal, object)?;
    let has_grippers = !model.problem.graph.grippers.is_empty();
    Some(Infeasibility::ObjectNeverMoves { object: name(model, object), distance, angle, has_grippers })
}

/// An object that has to be moved, all of whose grasps are ruled out where it starts, or where each of the goals has it.
fn no_grasp_is_possible(model: &Model, settings: &SearchSettings, start: &Feasible) -> Option<Infeasibility> {
    let graph = &model.graph;
    objects_to_move(model, &start.q).into_iter().find_map(|object| {
        let refuted = |place, grasps| Infeasibility::NoGraspPossible { object: name(model, object), place, grasps };
        let root = model.objects()[object].root?;
        let here = Asked::At(model.kinematics.poses(&start.q)[root.at()]);
        if let Some(grasps) = ruled_out(model, settings, &start.q, object, &here) {
            let is_free = |state: &_| own_grasps(graph, state, object).next().is_none();
            let without = connected_states(graph, start.state, is_free);
            if stays(model, start, object, &without) {
                return Some(refuted(ObjectPlace::Start, grasps));
            }
        }
        if !moves_in_hands_alone(graph, object) {
            return None;
        }
        let at_goal = |goal| ruled_out(model, settings, &start.q, object, &asked(model, goal, object)?);
        let mut goals = model.problem.goals.iter().map(at_goal);
        let first = goals.next()??;
        goals.all(|grasps| grasps.is_some()).then(|| refuted(ObjectPlace::Goal, first))
    })
}

/// All grasps of an object with what rules each out where it is asked; `None` where one is not ruled out, and where there is none at all.
fn ruled_out(
    model: &Model,
    settings: &SearchSettings,
    start: &[f64],
    object: usize,
    place: &Asked,
) -> Option<Vec<ImpossibleGrasp>> {
    let robot = &model.problem.robot;
    let grasps = grasps_of(&model.graph, object);
    let why = |&(gripper, handle): &_| {
        let far = arm_length::too_far(model, (gripper, handle), object, place);
        let why = far.or_else(|| hand_fit::hand_in_object(model, settings, start, (gripper, handle), object))?;
        let (gripper, handle) = (&robot.grippers[gripper.at()].name, &robot.handles[handle.at()].name);
        Some(ImpossibleGrasp::new(gripper.clone(), handle.clone(), why))
    };
    let all: Option<Vec<_>> = grasps.iter().map(why).collect();
    all.filter(|all| !all.is_empty())
}

fn name(model: &Model, object: usize) -> String {
    model.problem.robot.parts[model.graph.objects[object].part.at()].name.clone()
}
