//! The constraint graph (P0 §II-D, P1 §II): states, transitions between them, and what foliates them.
//!
//! The graph is built once (`foliate_systems::graph_building`) and immutable during a search. Transitions and states are
//! also entities of the world, which carry ids from here together with weights and statistics.

mod constraint;
mod state;
mod transition;

pub use constraint::{ConstraintId, ConstraintKind, GraphConstraint};
pub use state::{State, StateId};
pub use transition::{Leg, Transition, TransitionId, TransitionKind};

use crate::problem::ObjectOptions;

/// States, transitions and the constraints that they share.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Resource))]
pub struct ConstraintGraph {
    /// Objects that may be moved, in the problem's order.
    pub objects: Vec<ObjectOptions>,
    /// Constraints, each stated once.
    pub constraints: Vec<GraphConstraint>,
    /// States; waypoints are not among them, since no node ever rests in one.
    pub states: Vec<State>,
    /// Transitions, in the order of the states they leave.
    pub transitions: Vec<Transition>,
}

impl ConstraintGraph {
    /// The constraint of that id.
    ///
    /// # Panics
    /// If the id is of another graph.
    #[must_use]
    pub fn constraint(&self, id: ConstraintId) -> &GraphConstraint {
        &self.constraints[id.at()]
    }

    /// The state of that id.
    ///
    /// # Panics
    /// If the id is of another graph.
    #[must_use]
    pub fn state(&self, id: StateId) -> &State {
        &self.states[id.at()]
    }

    /// The transition of that id.
    ///
    /// # Panics
    /// If the id is of another graph.
    #[must_use]
    pub fn transition(&self, id: TransitionId) -> &Transition {
        &self.transitions[id.at()]
    }

    /// Transitions that leave a state.
    pub fn leaving(&self, state: StateId) -> impl Iterator<Item = (TransitionId, &Transition)> {
        let start = self.transitions.partition_point(|t| t.from < state);
        let count = self.transitions[start..].partition_point(|t| t.from == state);
        (start as u32..).map(TransitionId).zip(&self.transitions[start..start + count])
    }

    /// The loop of a state: motions that stay in it.
    #[must_use]
    pub fn loop_of(&self, state: StateId) -> Option<TransitionId> {
        self.leaving(state).find(|(_, t)| t.kind == TransitionKind::Loop).map(|(id, _)| id)
    }

    /// The transition of that name.
    #[must_use]
    pub fn transition_named(&self, name: &str) -> Option<TransitionId> {
        self.transitions.iter().position(|t| t.name == name).map(|i| TransitionId(i as u32))
    }

    /// The state of that name.
    #[must_use]
    pub fn state_named(&self, name: &str) -> Option<StateId> {
        self.states.iter().position(|s| s.name == name).map(|i| StateId(i as u32))
    }
}
