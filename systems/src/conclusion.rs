//! Set Conclude: is it over, and what does the host hear?

use crate::events::{EventSink, SearchEvent, StopSignal};
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res, ResMut, Resource};
use foliate_components::candidate::Candidate;
use foliate_components::leaf::LeafIndex;
use foliate_components::outcome::SearchOutcome;
use foliate_components::roadmap::{NodeId, Roadmap};

/// The roots of the trees that are to meet.
#[derive(Clone, Debug, Default, Resource)]
pub struct Roots {
    /// Root of the start's tree.
    pub start: Option<NodeId>,
    /// Roots of the goals' trees.
    pub goals: Vec<NodeId>,
}

/// How the search has ended, once it has.
#[derive(Clone, Debug, Default, Resource)]
pub struct Ending(pub Option<SearchOutcome>);

impl Roots {
    /// The first goal that hangs together with the start.
    #[must_use]
    pub fn reached_goal(&self, roadmap: &Roadmap) -> Option<NodeId> {
        let start = roadmap.component_of(self.start?);
        self.goals.iter().copied().find(|&goal| roadmap.component_of(goal) == start)
    }
}

/// Ends the search when a goal is reached, a budget is spent, or the host or its clock says so; tells the host.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn conclude(
    settings: Res<'_, SearchSettings>,
    counter: Res<'_, StepCounter>,
    stop: Res<'_, StopSignal>,
    roots: Res<'_, Roots>,
    roadmap: Res<'_, Roadmap>,
    leaves: Res<'_, LeafIndex>,
    candidates: Query<'_, '_, &Candidate>,
    mut events: ResMut<'_, EventSink>,
    mut ending: ResMut<'_, Ending>,
) {
    let solved = roots.reached_goal(&roadmap).is_some();
    // A signal raised during the step has cut some of its candidates short: what the step found is no answer then, even
    // if it solves the problem, because another run would have found another.
    ending.0 = if stop.token.is_cancelled() {
        Some(SearchOutcome::Cancelled)
    } else if stop.is_raised() {
        Some(SearchOutcome::Timeout)
    } else if solved {
        Some(SearchOutcome::Solved)
    } else if roadmap.nodes().len() >= settings.max_nodes {
        Some(SearchOutcome::MemoryLimit)
    } else if settings.max_steps > 0 && counter.step >= settings.max_steps {
        Some(SearchOutcome::StepLimit)
    } else {
        None
    };
    if events.is_open() {
        report(&counter, &roadmap, &leaves, &candidates, &mut events);
        if ending.0 == Some(SearchOutcome::Solved) {
            events.send(SearchEvent::Solved { step: counter.step });
        }
    }
}

fn report(
    counter: &StepCounter,
    roadmap: &Roadmap,
    leaves: &LeafIndex,
    candidates: &Query<'_, '_, &Candidate>,
    events: &mut EventSink,
) {
    for candidate in candidates {
        if let Some(reason) = candidate.rejected {
            events.send(SearchEvent::Rejected { step: counter.step, transition: candidate.transition, reason });
        }
    }
    events.send(SearchEvent::Progress {
        step: counter.step,
        candidates: counter.candidates,
        nodes: roadmap.nodes().len(),
        edges: roadmap.edges().len(),
        leaves: leaves.leaves().len(),
    });
}
