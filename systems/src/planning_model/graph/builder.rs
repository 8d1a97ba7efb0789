//! Adds states and constraints to a graph, each once.

use crate::planning_model::graph::states::state_keys::{StateKey, StateKeys};
use foliate_components::graph::{
    ConstraintGraph, ConstraintId, ConstraintKind, Fingers, GraphConstraint, State, StateId,
};
use std::collections::HashMap;
use std::sync::Arc;

/// Where the states and constraints of a graph are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Census {
    pub constraint_ids: HashMap<ConstraintKind, ConstraintId>,
    pub state_ids: HashMap<Arc<StateKey>, StateId>,
    /// By state.
    pub state_keys: Vec<Arc<StateKey>>,
}

/// Adds to a graph.
pub(crate) struct Builder<'a> {
    pub state_keys: StateKeys<'a>,
    pub graph: &'a mut ConstraintGraph,
    pub census: &'a mut Census,
}

impl Builder<'_> {
    pub(super) fn make_state(&mut self, key: StateKey) -> StateId {
        let kinds = self.state_keys.manifold(&key);
        let manifold: Vec<_> = kinds.into_iter().map(|kind| self.constraint(kind)).collect();
        let foliation = manifold.iter().copied().filter(|&c| self.graph.constraint(c).foliates).collect();
        let id = self.graph.add_state(State {
            name: self.state_keys.state_name(&key),
            written: (!self.state_keys.options.states.is_empty()).then_some(key.written as u32),
            grasps: key.grasps.clone(),
            fingers: key.fingers,
            manifold,
            foliation,
            priority: key.grasps.len() as u32,
        });
        let key = Arc::new(key);
        self.census.state_ids.insert(Arc::clone(&key), id);
        self.census.state_keys.push(key);
        id
    }

    /// The state of a case. In a lazy graph it comes into being, if it is allowed.
    pub fn state(&mut self, key: StateKey) -> Option<StateId> {
        if let Some(&id) = self.census.state_ids.get(&key) {
            return Some(id);
        }
        (self.graph.lazy && self.state_keys.are_allowed(&key.grasps)).then(|| {
            let state = self.make_state(key);
            self.let_fingers_move(state);
            state
        })
    }

    /// Adds the state that differs from one in that the fingers of all hands may move. Roots may have hands open as far as they like.
    pub(super) fn let_fingers_move(&mut self, state: StateId) {
        if self.state_keys.options.hands.iter().any(|hand| !hand.fingers.is_empty()) {
            self.passing_state(StateKey { fingers: Fingers::Free, ..StateKey::clone(&self.key(state)) });
        }
    }

    pub(super) fn constraint(&mut self, kind: ConstraintKind) -> ConstraintId {
        if let Some(&id) = self.census.constraint_ids.get(&kind) {
            return id;
        }
        let (name, foliates) = self.state_keys.describe(kind);
        let id = ConstraintId(self.graph.constraints.len() as u32);
        self.graph.constraints.push(GraphConstraint { name, kind, foliates });
        self.census.constraint_ids.insert(kind, id);
        id
    }

    pub(super) fn key(&self, state: StateId) -> Arc<StateKey> {
        Arc::clone(&self.census.state_keys[state.at()])
    }

    /// What `state` requires and `other` does not.
    pub(super) fn difference(&self, state: StateId, other: StateId) -> Vec<ConstraintId> {
        let other = &self.graph.state(other).manifold;
        self.graph.state(state).manifold.iter().copied().filter(|c| !other.contains(c)).collect()
    }

    /// A state that is only passed through.
    pub(super) fn passing_state(&mut self, key: StateKey) -> StateId {
        let known = self.census.state_ids.get(&key).copied();
        known.unwrap_or_else(|| self.make_state(key))
    }
}
