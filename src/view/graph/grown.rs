//! The graph of a problem, as far as a picture needs it; and the graph that a path has passed.

use crate::path_file::loaded_path::LoadedPath;
use foliate_components::graph::{ConstraintGraph, Fingers, State, StateId, Transition, TransitionKind};
use foliate_components::problem::Problem;
use foliate_systems::planning_model::graph::checks::GraphError;
use foliate_systems::planning_model::graph::enumeration::build_constraint_graph;
use foliate_systems::planning_model::{Model, ModelError, PlanningModel};
use foliate_systems::settings::SearchSettings;
use std::collections::{HashMap, VecDeque};
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
    let mut seen = std::collections::HashSet::from([start]);
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
        states.entry(name).or_insert_with(|| {
            graph.add_state(State {
                name: name.clone(),
                written: None,
                grasps: Vec::new(),
                fingers: Fingers::Still,
                manifold: Vec::new(),
                foliation: Vec::new(),
                priority: 0,
            })
        });
    }
    let names = path.states().iter().zip(path.transitions());
    let segments: Vec<(&String, &String)> = names.collect();
    for (index, (state, name)) in segments.iter().enumerate() {
        let from = states[state.as_str()];
        // A transition may have several segments, and ends in the state of the next that is another.
        let next = segments[index..].iter().find(|(_, other)| other != name);
        let to = next.map_or(from, |(state, _)| states[state.as_str()]);
        if graph.transition_named(name).is_none() {
            let kind = if from == to { TransitionKind::Loop } else { TransitionKind::Regular };
            let (legs, adds) = (Vec::new(), Vec::new());
            graph.transitions.push(Transition {
                name: (*name).clone(),
                from,
                to,
                kind,
                weight: 1.0,
                legs,
                adds,
                reverse: None,
            });
        }
    }
    graph.index();
    graph
}
