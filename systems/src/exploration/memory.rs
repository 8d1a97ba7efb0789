//! How much memory a search takes, counted from what it has done: budgets then depend on no clock, no thread and no other search.
//!
//! What is counted is what grows: the roadmap, unvalidated edges, a lazy graph, what is compiled of transitions when they are first
//! tried, the pool of placements, and what the scheduler says of itself ([`SchedulerBytes`]). `tests/memory_has_a_limit.rs` compares it with the process.

use crate::exploration::edges::UnvalidatedByEnd;
use crate::planning_model::model::PlanningModel;
use bevy_ecs::prelude::{Resource, World};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::roadmap::RoadmapStore;

/// A state that has come into being takes so many times what its graph's rows take: its case, entities of it and of what leaves
/// it, places for what may be compiled, the heuristic, and an allocator's rounding (measured on 16 arms and 60 boxes: 4.2 kB of 1.4).
const PER_GRAPH_BYTE: u64 = 3;

/// What the resources of a scheduler take, bytes. A scheduler whose resources grow writes it before set Conclude.
#[derive(Clone, Copy, Debug, Default, Resource)]
pub struct SchedulerBytes(pub u64);

/// What the pool of placements takes, bytes ([`crate::heuristic::placements`]).
#[derive(Clone, Copy, Debug, Default, Resource)]
pub struct PlacementBytes(pub u64);

/// What has been compiled for this search, by any search that shares the model.
#[derive(Clone, Debug, Default, Resource)]
pub struct Compiled {
    /// By transition.
    transitions: Vec<bool>,
    /// By state, whether its pairs are.
    states: Vec<bool>,
    bytes: u64,
}

impl Compiled {
    /// Remembers that a transition was tried.
    pub(crate) fn note(&mut self, model: &PlanningModel, transition: TransitionId) {
        if !first(&mut self.transitions, transition.at()) {
            return;
        }
        self.bytes += model.bytes_to_try(transition);
        for leg in &model.graph.transition(transition).legs {
            self.note_state(model, leg.state);
        }
    }

    fn note_state(&mut self, model: &PlanningModel, state: StateId) {
        if first(&mut self.states, state.at()) {
            self.bytes += model.bytes_of_pairs();
        }
    }

    /// About how many bytes that takes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Whether a flag was not set; it is now.
fn first(flags: &mut Vec<bool>, at: usize) -> bool {
    if flags.len() <= at {
        flags.resize(at + 1, false);
    }
    !std::mem::replace(&mut flags[at], true)
}

/// About how many bytes a search takes beyond what it was given.
#[must_use]
pub fn taken(
    model: &PlanningModel,
    roadmap: &RoadmapStore,
    unvalidated_edges: &UnvalidatedByEnd,
    compiled: &Compiled,
    (scheduler, placements): (&SchedulerBytes, &PlacementBytes),
) -> u64 {
    let graph = if model.graph.lazy { PER_GRAPH_BYTE * model.graph.bytes() } else { 0 };
    roadmap.bytes() + unvalidated_edges.bytes() + compiled.bytes() + graph + scheduler.0 + placements.0
}

/// As [`taken`], of the search in a world.
#[must_use]
pub fn taken_in(world: &World) -> u64 {
    let own = (world.resource(), world.resource());
    taken(world.resource(), world.resource(), world.resource(), world.resource(), own)
}
