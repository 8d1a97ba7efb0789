//! Which objects goals have elsewhere than the start, how far from there, and where.

use crate::planning_model::graph::support_placement::PlacementOnSupport;
use crate::planning_model::model::Model;
use foliate_components::Pose;
use foliate_components::graph::{ConstraintGraph, ConstraintKind, State, StateId};
use foliate_components::pose::pose_to_array;
use foliate_components::problem::{Goal, GraphOptions};
use foliate_components::robot::{GripperIndex, HandleIndex, Source, SurfaceIndex};

/// Goals that ask for less than so many times the tolerance of starts are left to the search: they may mean where the object stands.
const TOLERANCES: f64 = 2.0;

/// No tolerance is smaller here, metres and radians.
const LEAST: f64 = 1e-3;

/// Off a support by less than this an object rests on it, metres and radians.
const RESTS: f64 = 1e-3;

/// Where a goal has an object.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Asked {
    /// Its root link at this pose in the world.
    At(Pose),
    /// On one of these supports.
    On(Vec<SurfaceIndex>),
}

/// The objects that every goal has elsewhere than a start, by number: they have to be moved.
#[must_use]
pub fn objects_to_move(model: &Model, start: &[f64]) -> Vec<usize> {
    let goals = &model.problem.goals;
    let moves = |&object: &usize| goals.iter().all(|goal| displacement(model, start, goal, object).is_some());
    (0..model.objects().len()).filter(moves).filter(|_| !goals.is_empty()).collect()
}

/// A configuration with the root of an object at a pose in the world.
#[must_use]
pub(crate) fn with_object_at(model: &Model, q: &[f64], object: usize, pose: &Pose) -> Option<Vec<f64>> {
    let Source::Coordinates { q: first, .. } = model.problem.robot.joints[model.objects()[object].root?.at()].source
    else {
        return None;
    };
    let mut q = q.to_vec();
    q[first..first + 7].copy_from_slice(&pose_to_array(pose));
    Some(q)
}

/// Where a goal has an object; `None` where it says nothing of it that is known here.
#[must_use]
pub(crate) fn asked(model: &Model, goal: &Goal, object: usize) -> Option<Asked> {
    let (part, root) = (model.graph.objects[object].part, model.objects()[object].root?);
    match goal {
        Goal::Configuration(q) if q.len() == model.problem.robot.space.size() => {
            Some(Asked::At(model.kinematics.poses(q)[root.at()]))
        }
        Goal::Configuration(_) => None,
        Goal::Partial(goal) => {
            let pose = goal.poses.iter().find(|(named, _)| *named == part).map(|(_, pose)| Asked::At(*pose));
            let on = || goal.lying.iter().find(|(named, _)| *named == part);
            pose.or_else(|| on().map(|(_, supports)| Asked::On(supports.clone())))
        }
    }
}

/// How far a goal has an object from where the start has it, metres and radians, where that is farther than it may be off. Of a support
/// the distance is that from the nearest place on it.
#[must_use]
pub(crate) fn displacement(model: &Model, start: &[f64], goal: &Goal, object: usize) -> Option<(f64, f64)> {
    let X_WJ = model.kinematics.poses(start);
    let (distance, angle) = match asked(model, goal, object)? {
        Asked::At(pose) => {
            let by = X_WJ[model.objects()[object].root?.at()].inverse() * pose;
            (by.translation.length(), 2.0 * by.rotation.xyz().length().min(1.0).asin())
        }
        Asked::On(supports) => {
            let off = places_on(model, object, &supports).into_iter().map(|place| place.resting.residual(0.0, &X_WJ));
            (off.min_by(f64::total_cmp)?, 0.0)
        }
    };
    let tolerance = model.problem.start_tolerance;
    let is_elsewhere =
        distance > TOLERANCES * tolerance.distance.max(LEAST) || angle > TOLERANCES * tolerance.angle.max(LEAST);
    is_elsewhere.then_some((distance, angle))
}

/// How an object may rest on some supports alone, by the body that carries them.
#[must_use]
pub(crate) fn places_on(model: &Model, object: usize, supports: &[SurfaceIndex]) -> Vec<PlacementOnSupport> {
    let problem = &model.problem;
    let only = GraphOptions { supports: supports.to_vec(), ..problem.graph.clone() };
    PlacementOnSupport::of_object(&problem.robot, &only, &model.graph.objects[object]).unwrap_or_default()
}

/// All grasps of an object that the states of a graph know, each once.
#[must_use]
pub(crate) fn grasps_of(graph: &ConstraintGraph, object: usize) -> Vec<(GripperIndex, HandleIndex)> {
    let all = graph.states.iter().flat_map(|state| own_grasps(graph, state, object));
    let mut all: Vec<_> = all.collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The grasps of an object in a state.
pub(crate) fn own_grasps<'a>(
    graph: &'a ConstraintGraph,
    state: &'a State,
    object: usize,
) -> impl Iterator<Item = (GripperIndex, HandleIndex)> + 'a {
    state.grasps.iter().copied().filter(move |(_, handle)| graph.objects[object].handles.contains(handle))
}

/// Whether nothing but a hand moves an object in any state that is known: in each it is held, or its place in the world is a value of the
/// leaf.
#[must_use]
pub(crate) fn moves_in_hands_alone(graph: &ConstraintGraph, object: usize) -> bool {
    let states = (0u32..).map(StateId).zip(&graph.states);
    let stands = |state: &State| state.foliation.iter().any(|&c| stands_in_world(graph.constraint(c).kind, object));
    states.into_iter().all(|(_, state)| stands(state) || own_grasps(graph, state, object).next().is_some())
}

/// Whether a constraint is that an object stands in the world.
#[must_use]
pub(crate) fn stands_in_world(kind: ConstraintKind, object: usize) -> bool {
    match kind {
        ConstraintKind::Placement { object: lying, on: None } | ConstraintKind::Rest { object: lying } => {
            lying as usize == object
        }
        _ => false,
    }
}

/// Whether an object rests on what moves where the bodies are, and on nothing that is fixed.
#[must_use]
pub(crate) fn rests_on_what_moves(model: &Model, object: usize, X_WJ: &[Pose]) -> bool {
    let rests = |place: &PlacementOnSupport| place.resting.residual(0.0, X_WJ) <= RESTS;
    let resting = &model.objects()[object].resting;
    resting.iter().any(|place| place.on.is_some() && rests(place))
        && !resting.iter().any(|place| place.on.is_none() && rests(place))
}
