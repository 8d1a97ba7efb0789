//! Objects that goals have elsewhere than the start, and those of them that no transition moves: a proof that no goal can be reached.
//!
//! Each leg of a transition keeps the values of its leaf. So a constraint that foliates every state in reach of the start keeps its value
//! along every path: an object whose placement in the world is such a constraint stays where it starts.

use crate::planning_model::model::Model;
use crate::planning_model::state_classification::Feasible;
use foliate_components::Pose;
use foliate_components::graph::{ConstraintGraph, ConstraintId, ConstraintKind, StateId};
use foliate_components::infeasibility::Infeasibility;
use foliate_components::pose::pose_to_array;
use foliate_components::problem::Goal;
use foliate_components::robot::{PartIndex, Source};

/// Goals that ask for less than so many times the tolerance of starts are left to the search: they may mean where the object stands.
const TOLERANCES: f64 = 2.0;

/// No tolerance is smaller here, metres and radians.
const LEAST: f64 = 1e-3;

/// The reason why no goal can be reached, where every goal moves an object that nothing moves. Nothing is said of lazy graphs, whose states are
/// not known.
pub(crate) fn refute(model: &Model, start: &Feasible) -> Option<Infeasibility> {
    let goals = &model.problem.goals;
    if model.graph.lazy || goals.is_empty() {
        return None;
    }
    let fixed = immovable(model, start);
    let reason = |goal| fixed.iter().find_map(|&object| contradiction(model, &start.q, goal, object));
    let mut reasons = goals.iter().map(reason);
    let first = reasons.next()??;
    reasons.all(|reason| reason.is_some()).then_some(first)
}

/// The objects that stand in the world in the start and in whatever can be reached from there, by number.
fn immovable(model: &Model, start: &Feasible) -> Vec<usize> {
    let graph = &model.graph;
    let states = reachable(graph, start.state);
    let stays =
        |constraint: ConstraintId| states.iter().all(|state| graph.state(*state).foliation.contains(&constraint));
    let of_start = graph.state(start.state).foliation.iter().zip(&start.parameters);
    let in_world = of_start.filter(|(_, value)| value.carrier.is_none()).map(|(&constraint, _)| constraint);
    let object = |constraint: ConstraintId| match graph.constraint(constraint).kind {
        ConstraintKind::Placement { object, on: None } | ConstraintKind::Rest { object } => Some(object as usize),
        _ => None,
    };
    in_world.filter(|&constraint| stays(constraint)).filter_map(object).collect()
}

/// The states in reach of one, and those that legs pass through, each once.
fn reachable(graph: &ConstraintGraph, from: StateId) -> Vec<StateId> {
    let mut states = vec![from];
    let mut next = 0;
    while next < states.len() {
        for (_, transition) in graph.leaving(states[next]) {
            for state in transition.legs.iter().map(|leg| leg.state).chain([transition.to]) {
                if !states.contains(&state) {
                    states.push(state);
                }
            }
        }
        next += 1;
    }
    states
}

/// The objects that every goal has elsewhere than a start, by number: they have to be moved.
#[must_use]
pub fn objects_to_move(model: &Model, start: &[f64]) -> Vec<usize> {
    let goals = &model.problem.goals;
    let moves = |&object: &usize| goals.iter().all(|goal| displacement(model, start, goal, object).is_some());
    (0..model.objects().len()).filter(moves).filter(|_| !goals.is_empty()).collect()
}

/// A configuration that has an object where the first goal that says so has it: the goal, or a start with the object moved.
#[must_use]
pub fn at_goal(model: &Model, start: &[f64], object: usize) -> Option<Vec<f64>> {
    let (part, root) = (model.graph.objects[object].part, model.objects()[object].root?);
    let Source::Coordinates { q: first, .. } = model.problem.robot.joints[root.at()].source else { return None };
    model.problem.goals.iter().find_map(|goal| match goal {
        Goal::Configuration(q) => (q.len() == start.len()).then(|| q.clone()),
        Goal::Partial(goal) => goal.poses.iter().find(|(asked, _)| *asked == part).map(|(_, pose)| {
            let mut q = start.to_vec();
            q[first..first + 7].copy_from_slice(&pose_to_array(pose));
            q
        }),
    })
}

fn contradiction(model: &Model, start: &[f64], goal: &Goal, object: usize) -> Option<Infeasibility> {
    let (distance, angle) = displacement(model, start, goal, object)?;
    Some(Infeasibility::ObjectNeverMoves {
        object: name(model, model.graph.objects[object].part),
        distance,
        angle,
        has_grippers: !model.problem.graph.grippers.is_empty(),
    })
}

/// How far a goal has an object from where the start has it, metres and radians, where that is farther than it may be off.
fn displacement(model: &Model, start: &[f64], goal: &Goal, object: usize) -> Option<(f64, f64)> {
    let (part, root) = (model.graph.objects[object].part, model.objects()[object].root?);
    let pose = |q: &[f64]| {
        let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
        model.kinematics.forward(q, &mut X_WJ);
        X_WJ[root.at()]
    };
    let asked = match goal {
        Goal::Configuration(q) if q.len() == start.len() => pose(q),
        Goal::Configuration(_) => return None,
        Goal::Partial(goal) => goal.poses.iter().find(|(asked, _)| *asked == part)?.1,
    };
    let by = pose(start).inverse() * asked;
    let (distance, angle) = (by.translation.length(), 2.0 * by.rotation.xyz().length().min(1.0).asin());
    let tolerance = model.problem.start_tolerance;
    let is_elsewhere =
        distance > TOLERANCES * tolerance.distance.max(LEAST) || angle > TOLERANCES * tolerance.angle.max(LEAST);
    is_elsewhere.then_some((distance, angle))
}

fn name(model: &Model, part: PartIndex) -> String {
    model.problem.robot.parts[part.0 as usize].name.clone()
}
