//! The constraint graph (P0 §II-D, P1 §II): states, transitions between them, and what foliates them.
//!
//! A small graph is built whole (`foliate_systems::planning_model::graph::enumeration`); a large one is lazy: a state comes into being when it is
//! first reached or seen from a neighbour, its transitions when it is *expanded* (`foliate_systems::planning_model::graph::lazy_graph`). Ids never
//! change; nothing is ever taken away. Transitions and states are also entities of the world, which carry ids from here
//! together with weights and statistics.

use crate::graph::leaf::{Leaf, ParameterId};
use crate::graph::{ConstraintId, GraphConstraint, State, StateId, Transition, TransitionId, TransitionKind};
use crate::problem::ObjectOptions;
use std::ops::{Index, Range};

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
    /// Transitions, those that leave one state side by side.
    pub transitions: Vec<Transition>,
    /// Whether there are states and transitions that have not come into being, because nothing has reached them.
    pub lazy: bool,
    /// By state: where the transitions that leave it stand.
    ranges: Vec<Range<u32>>,
    /// Length of `transitions` for which `ranges` holds.
    indexed: usize,
    bytes: u64,
}

impl ConstraintGraph {
    /// A graph without states.
    #[must_use]
    pub fn new(objects: Vec<ObjectOptions>) -> Self {
        Self { objects, ..Self::default() }
    }

    /// Adds a state.
    pub fn add_state(&mut self, state: State) -> StateId {
        let id = StateId(self.states.len() as u32);
        self.bytes += state.bytes();
        self.states.push(state);
        id
    }

    /// Adds all transitions that leave a state.
    pub fn add_leaving(&mut self, state: StateId, transitions: Vec<Transition>) {
        let first = self.transitions.len();
        self.bytes += transitions.iter().map(Transition::bytes).sum::<u64>();
        self.transitions.extend(transitions);
        if self.indexed == first {
            self.ranges.resize(self.states.len().max(state.at() + 1), 0..0);
            self.ranges[state.at()] = first as u32..self.transitions.len() as u32;
            self.indexed = self.transitions.len();
        }
    }

    /// Finds out anew which transitions leave which state, for a graph whose transitions were written by hand.
    pub fn index(&mut self) {
        self.ranges = vec![0..0; self.states.len()];
        for (number, transition) in (0u32..).zip(&self.transitions) {
            let Some(range) = self.ranges.get_mut(transition.from.at()) else { continue };
            let start = if range.start == range.end { number } else { range.start };
            *range = start..number + 1;
        }
        self.indexed = self.transitions.len();
    }

    /// Whether the transitions that leave a state are there.
    #[must_use]
    pub fn is_expanded(&self, state: StateId) -> bool {
        !self.lazy || self.leaving(state).next().is_some()
    }

    /// About how many bytes the states and transitions take that were added one by one; a bound for budgets, without the
    /// rounding of an allocator.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

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

    /// Transitions that leave a state, by id; none of a state that is not expanded.
    pub fn leaving(&self, state: StateId) -> impl Iterator<Item = (TransitionId, &Transition)> {
        // Hands may have taken transitions away since they were indexed; then all have to be compared.
        let range = match self.indexed == self.transitions.len() {
            true => self.ranges.get(state.at()).cloned().unwrap_or(0..0),
            false => 0..self.transitions.len() as u32,
        };
        let here = &self.transitions[range.start as usize..range.end as usize];
        (range.start..).map(TransitionId).zip(here).filter(move |(_, t)| t.from == state)
    }

    /// The loop of a state: motions that stay in it.
    #[must_use]
    pub fn loop_of(&self, state: StateId) -> Option<TransitionId> {
        self.leaving(state).find(|(_, t)| t.kind == TransitionKind::Loop).map(|(id, _)| id)
    }

    /// The value that a leaf gives a constraint, where the constraint foliates its state.
    #[must_use]
    pub fn value(&self, leaf: &Leaf, constraint: ConstraintId) -> Option<ParameterId> {
        let position = self.state(leaf.state).foliation.iter().position(|&c| c == constraint)?;
        leaf.parameters.get(position).copied()
    }

    /// The states in which nodes of a roadmap may lie, by id: all but those that are only passed through.
    pub fn states_of_nodes(&self) -> impl Iterator<Item = (StateId, &State)> {
        (0u32..).map(StateId).zip(&self.states).filter(|(_, state)| !state.is_passed_through())
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

impl Index<StateId> for ConstraintGraph {
    type Output = State;

    fn index(&self, id: StateId) -> &State {
        self.state(id)
    }
}

impl Index<TransitionId> for ConstraintGraph {
    type Output = Transition;

    fn index(&self, id: TransitionId) -> &Transition {
        self.transition(id)
    }
}

impl Index<ConstraintId> for ConstraintGraph {
    type Output = GraphConstraint;

    fn index(&self, id: ConstraintId) -> &GraphConstraint {
        self.constraint(id)
    }
}
