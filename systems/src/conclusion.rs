//! Set Conclude: is it over, and what does the host hear?

use crate::events::{EventSink, SearchEvent, StopSignal};
use crate::goals::GoalSampler;
use crate::memory::{self, Compiled};
use crate::model::PlanningModel;
use crate::passages::Passages;
use crate::schedule::StepCounter;
use crate::sequences::leaf_graph::LeafGraph;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res, ResMut, Resource};
use foliate_components::candidate::Candidate;
use foliate_components::graph::leaf::LeafIndex;
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

/// Ends the search when a goal is reached, a budget is spent, or the host or its clock says so.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn conclude(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    counter: Res<'_, StepCounter>,
    stop: Res<'_, StopSignal>,
    roots: Res<'_, Roots>,
    roadmap: Res<'_, Roadmap>,
    passages: Res<'_, Passages>,
    goals: Res<'_, GoalSampler>,
    compiled: Res<'_, Compiled>,
    joins: Option<Res<'_, LeafGraph>>,
    mut ending: ResMut<'_, Ending>,
) {
    let solved = roots.reached_goal(&roadmap).is_some();
    // A signal raised during the step has cut some of its candidates short: what the step found is no answer then, even
    // if it solves the problem, because another run would have found another.
    ending.0 = if stop.token.is_cancelled() {
        Some(SearchOutcome::Cancelled)
    } else if stop.is_out_of_memory() {
        Some(SearchOutcome::MemoryLimit)
    } else if stop.is_raised() {
        Some(SearchOutcome::Timeout)
    } else if solved {
        Some(SearchOutcome::Solved)
    } else if roadmap.nodes().len() >= settings.max_nodes
        || memory::taken(&model, &roadmap, &passages, &compiled, joins.as_deref()) >= settings.max_bytes
    {
        Some(SearchOutcome::MemoryLimit)
    } else if let Some(why) = no_goal(&roots, &goals, &model, &settings) {
        Some(SearchOutcome::InfeasibleGoal(why))
    } else if settings.max_steps > 0 && counter.step >= settings.max_steps {
        Some(SearchOutcome::StepLimit)
    } else {
        None
    };
}

/// Why there is no goal and none will be found.
fn no_goal(roots: &Roots, goals: &GoalSampler, model: &PlanningModel, settings: &SearchSettings) -> Option<String> {
    roots.goals.is_empty().then(|| goals.given_up(model, settings)).flatten()
}

/// Tells the host, where it listens, what became of the step's candidates and how far the search is.
pub fn report_progress(
    counter: Res<'_, StepCounter>,
    roadmap: Res<'_, Roadmap>,
    leaves: Res<'_, LeafIndex>,
    candidates: Query<'_, '_, &Candidate>,
    mut events: ResMut<'_, EventSink>,
) {
    if !events.is_open() {
        return;
    }
    for candidate in &candidates {
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

/// Tells the host that the search is solved: the last event of all.
pub fn report_solution(counter: Res<'_, StepCounter>, ending: Res<'_, Ending>, mut events: ResMut<'_, EventSink>) {
    if ending.0 == Some(SearchOutcome::Solved) {
        events.send(SearchEvent::Solved { step: counter.step });
    }
}
