//! Graphs that are too large to be built whole (8 grippers × 20 handles make 9·10⁹ states) and grow while they are searched.
//!
//! A state comes into being when a configuration in it is looked for or when it is the neighbour of a state that has been
//! *expanded*; a state is expanded, that is, gets its transitions, when a node first lies in it. Both happen only between
//! parallel systems, in the order of the candidates, so ids do not depend on threads. Names, constraints, weights and
//! transitions are those of the whole graph; only ids follow the search.

use crate::planning_model::graph::builder::{Builder, Census};
use crate::planning_model::graph::checks::{GraphError, check};
use crate::planning_model::graph::states::state_keys::{Documents, StateKey, StateKeys, grasp_sets, handles};
use foliate_components::constraint::Grasp;
use foliate_components::graph::{ConstraintGraph, ConstraintKind, Fingers, StateId};
use foliate_components::problem::Problem;
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex};
use std::sync::Arc;

/// More transitions than this from one state are refused: a search has to draw from all of them.
pub(crate) const MOST_LEAVING: usize = 50_000;

/// Ways in which a configuration may be read (who holds, what lies where); beyond, it is read as in no state.
const MOST_READINGS: usize = 20_000;

/// What a lazy graph grows from.
#[derive(Clone, Debug)]
pub(crate) struct LazyGraph {
    documents: Arc<Documents>,
    census: Census,
}

impl LazyGraph {
    /// A graph without states, and what it grows from.
    ///
    /// # Errors
    /// Documents that make no graph, and [`GraphError::TooManyTransitions`].
    pub fn new(problem: &Problem) -> Result<(ConstraintGraph, Self), GraphError> {
        check(problem)?;
        let documents = Documents::new(problem)?;
        let bodies = documents.bodies.iter().map(Vec::len).max().unwrap_or(0).max(1);
        let grasps = documents.grasps.len();
        // Every grasp may be made, or released onto every body; each has a crossed twin.
        let leaving = grasps.saturating_mul(bodies).saturating_mul(2).saturating_add(problem.graph.transitions.len());
        if leaving > MOST_LEAVING {
            return Err(GraphError::TooManyTransitions { grasps, bodies, most: MOST_LEAVING });
        }
        let mut graph = ConstraintGraph::new(problem.graph.objects.clone());
        graph.lazy = true;
        Ok((graph, Self { documents: Arc::new(documents), census: Census::default() }))
    }

    /// The documents of a grasp.
    pub fn grasp(&self, gripper: GripperIndex, handle: HandleIndex) -> Option<&Grasp> {
        self.documents.grasps.get(&(gripper, handle))
    }

    /// The state of a case, where it has come into being.
    pub fn known(&self, key: &StateKey) -> Option<StateId> {
        self.census.state_ids.get(key).copied()
    }

    /// Makes a state come into being; `None` where it is not allowed.
    pub fn reach(&mut self, problem: &Problem, graph: &mut ConstraintGraph, key: StateKey) -> Option<StateId> {
        self.builder(problem, graph, |builder| builder.state(key))
    }

    /// Gives a state its transitions, and existence to its neighbours.
    pub fn expand(&mut self, problem: &Problem, graph: &mut ConstraintGraph, state: StateId) {
        if graph.is_expanded(state) {
            return;
        }
        self.builder(problem, graph, |builder| {
            builder.make_transitions(state);
            builder.link_reverses_around(state);
        });
    }

    fn builder<R>(
        &mut self,
        problem: &Problem,
        graph: &mut ConstraintGraph,
        build: impl FnOnce(&mut Builder<'_>) -> R,
    ) -> R {
        let state_keys = StateKeys::new(problem, &self.documents);
        build(&mut Builder { state_keys, graph, census: &mut self.census })
    }

    /// The case with most grasps of which everything `holds`; among equals the first in the order of the whole graph.
    pub fn key_where(&self, problem: &Problem, holds: impl Fn(ConstraintKind) -> bool) -> Option<StateKey> {
        let state_keys = StateKeys::new(problem, &self.documents);
        let grasped = |gripper, handle| holds(ConstraintKind::Grasp { gripper, handle });
        let pairs: Vec<_> = (problem.graph.grippers.iter())
            .flat_map(|&g| handles(&problem.graph).map(move |h| (g, h)))
            .filter(|&(g, h)| self.grasp(g, h).is_some() && grasped(g, h))
            .collect();
        let mut sets = grasp_sets(&problem.graph, |g, h| pairs.contains(&(g, h)), MOST_READINGS)?;
        // Stable: among sets of one size the order stays.
        sets.sort_by_key(|grasps| std::cmp::Reverse(grasps.len()));
        let lies = |object: usize, body: Option<JointIndex>| holds(state_keys.resting_constraint(object, body));
        for grasps in sets {
            let ways = state_keys.ways_to_lie(&grasps, lies, MOST_READINGS)?;
            for written in 0..problem.graph.states.len().max(1) {
                for lying in &ways {
                    let key =
                        StateKey { written, grasps: grasps.clone(), lying: lying.clone(), fingers: Fingers::Still };
                    if state_keys.manifold(&key).into_iter().all(&holds) {
                        return Some(key);
                    }
                }
            }
        }
        None
    }

    /// The constraint that is farthest from holding in a state without grasps, every object where it is nearest to lying:
    /// what it is, its name, the state's, and by how much. For messages.
    pub fn worst_when_free(
        &self,
        problem: &Problem,
        residual: impl Fn(ConstraintKind) -> f64,
    ) -> Option<(ConstraintKind, String, String, f64)> {
        let state_keys = StateKeys::new(problem, &self.documents);
        let nearest = |(object, bodies): (usize, &Vec<Option<JointIndex>>)| {
            let apart = |&body: &Option<JointIndex>| residual(state_keys.resting_constraint(object, body));
            bodies.iter().copied().min_by(|a, b| apart(a).total_cmp(&apart(b))).flatten()
        };
        let lying = self.documents.bodies.iter().enumerate().map(nearest).collect();
        let key = StateKey { written: 0, grasps: Vec::new(), lying, fingers: Fingers::Still };
        let all = state_keys.manifold(&key).into_iter().map(|kind| (kind, residual(kind)));
        let (kind, worst) = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((kind, state_keys.describe(kind).0, state_keys.state_name(&key), worst))
    }
}
