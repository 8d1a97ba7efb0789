//! The graph of a problem, as far as a picture needs it; the graph that a path has passed, and that of a recording.

use crate::path_file::loaded_path::LoadedPath;
use crate::planner::recording::Recording;
use foliate_components::graph::{ConstraintGraph, Fingers, State, StateId, Transition, TransitionKind};
use foliate_components::problem::Problem;
use foliate_components::robot::{GripperIndex, HandleIndex};
use foliate_systems::planning_model::graph::checks::GraphError;
use foliate_systems::planning_model::graph::enumeration::build_constraint_graph;
use foliate_systems::planning_model::{Model, ModelError, PlanningModel};
use foliate_systems::settings::SearchSettings;
use std::collections::{HashMap, HashSet, VecDeque};
use std::sync::Arc;

/// A large graph grows until so many states have come into being.
const STATES: usize = 150;

/// The whole graph; of one that is too large, what surrounds the start, as far as that lies in a state.
///
/// # Errors
/// The problem has no graph.
pub fn grown_graph(problem: &Problem) -> Result<ConstraintGraph, ModelError> {
    match build_constraint_graph(problem) {
        Ok(graph) => return Ok(graph),
        Err(GraphError::TooManyStates { .. }) => {}
        Err(other) => return Err(other.into()),
    }
    let mut model = PlanningModel(Arc::new(Model::new_lazy(problem.clone())?));
    let tolerance = SearchSettings::default().classification_tolerance;
    if let Some(start) = model.reach(&problem.start, tolerance) {
        grow(&mut model, start);
    }
    Ok(model.graph.clone())
}

/// Expands states from one on, the nearest first, until there are many.
pub(crate) fn grow(model: &mut PlanningModel, start: StateId) {
    let mut queue = VecDeque::from([start]);
    let mut seen = HashSet::from([start]);
    while let Some(state) = queue.pop_front() {
        if model.graph.states.len() > STATES {
            break;
        }
        model.expand(state);
        let next: Vec<StateId> = model.graph.leaving(state).map(|(_, transition)| transition.to).collect();
        queue.extend(next.into_iter().filter(|&state| seen.insert(state)));
    }
}

/// The states and transitions that a path names, as a graph of its own.
pub(crate) fn passed(path: &LoadedPath) -> ConstraintGraph {
    let mut graph = ConstraintGraph::new(Vec::new());
    let mut states: HashMap<&str, StateId> = HashMap::new();
    for name in path.states() {
        states.entry(name).or_insert_with(|| graph.add_state(named_state(name)));
    }
    let names = path.states().iter().zip(path.transitions());
    let segments: Vec<(&String, &String)> = names.collect();
    // A transition may have several segments, and ends in the state of the next that is another.
    let mut nexts = vec![None; segments.len()];
    for index in (1..segments.len()).rev() {
        let (state, name) = segments[index];
        nexts[index - 1] = if segments[index - 1].1 == name { nexts[index] } else { Some(states[state.as_str()]) };
    }
    let mut seen = HashSet::new();
    for ((state, name), next) in segments.iter().zip(nexts) {
        let from = states[state.as_str()];
        let to = next.unwrap_or(from);
        if seen.insert(name.as_str()) {
            let kind = if from == to { TransitionKind::Loop } else { TransitionKind::Regular };
            graph.transitions.push(bare_transition(name, (from, to), kind));
        }
    }
    graph.index();
    graph
}

/// The graph of a recording: states and transitions with their places in it as numbers, and no constraints.
pub(crate) fn recorded(recording: &Recording) -> ConstraintGraph {
    let mut graph = ConstraintGraph::new(Vec::new());
    for row in &recording.head.states {
        // Who holds what is in the name; a picture asks how many do.
        let grasps = row.name.matches(" grasps ").map(|_| (GripperIndex(0), HandleIndex(0))).collect();
        let fingers = if row.passed_through { Fingers::Free } else { Fingers::Still };
        graph.add_state(State { grasps, fingers, ..named_state(&row.name) });
    }
    for row in &recording.head.transitions {
        let kind = match row.kind.as_str() {
            "loop" => TransitionKind::Loop,
            "crossed" => TransitionKind::Crossed,
            _ => TransitionKind::Regular,
        };
        graph.transitions.push(bare_transition(&row.name, (StateId(row.from), StateId(row.to)), kind));
    }
    graph.index();
    graph
}

/// A state of which nothing is known but its name.
fn named_state(name: &str) -> State {
    State {
        name: name.to_owned(),
        written: None,
        grasps: Vec::new(),
        fingers: Fingers::Still,
        manifold: Vec::new(),
        foliation: Vec::new(),
        priority: 0,
    }
}

fn bare_transition(name: &str, (from, to): (StateId, StateId), kind: TransitionKind) -> Transition {
    let (name, legs, adds) = (name.to_owned(), Vec::new(), Vec::new());
    Transition { name, from, to, kind, weight: 1.0, legs, adds, reverse: None }
}
