//! Set Conclude: is it over, and what does the host hear?

use crate::events::{EventSink, Feedback, MOST_STATES, MOST_TRANSITIONS, SearchEvent, StopSignal, TransitionFeedback};
use crate::exploration::edges::UnvalidatedByEnd;
use crate::exploration::memory;
use crate::exploration::memory::{Compiled, PlacementBytes, SchedulerBytes};
use crate::exploration::roadmap_query::RoadmapQuery;
use crate::exploration::roots::{Ending, Roots};
use crate::goals::sampler::GoalSampler;
use crate::planning_model::model::PlanningModel;
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res, ResMut};
use foliate_components::candidate::Candidate;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::infeasibility::Infeasibility;
use foliate_components::outcome::{Prior, SearchOutcome, StateStatistics, TransitionStatistics};
use foliate_components::roadmap::RoadmapStore;

/// Ends the search when a goal is reached, a budget is spent, or the host or its clock says so.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn conclude(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    counter: Res<'_, StepCounter>,
    stop: Res<'_, StopSignal>,
    roots: Res<'_, Roots>,
    roadmap: RoadmapQuery<'_, '_>,
    store: Res<'_, RoadmapStore>,
    unvalidated_edges: Res<'_, UnvalidatedByEnd>,
    goals: Res<'_, GoalSampler>,
    compiled: Res<'_, Compiled>,
    scheduler: Res<'_, SchedulerBytes>,
    placements: Res<'_, PlacementBytes>,
    mut ending: ResMut<'_, Ending>,
) {
    let roadmap = roadmap.view();
    let solved = roots.reached_goal(roadmap).is_some();
    ending.0 = if let Some(stopped) = stop.outcome() {
        Some(stopped)
    } else if solved {
        Some(SearchOutcome::Solved)
    } else if roadmap.nodes().len() >= settings.max_nodes
        || memory::taken(&model, &store, &unvalidated_edges, &compiled, (&scheduler, &placements)) >= settings.max_bytes
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
fn no_goal(
    roots: &Roots,
    goals: &GoalSampler,
    model: &PlanningModel,
    settings: &SearchSettings,
) -> Option<Infeasibility> {
    roots.goals.is_empty().then(|| goals.given_up(model, settings)).flatten()
}

/// Tells the host, where it listens, what became of the step's candidates and how far the search is.
pub fn report_progress(
    counter: Res<'_, StepCounter>,
    roadmap: RoadmapQuery<'_, '_>,
    leaves: Res<'_, LeafIndex>,
    candidates: Query<'_, '_, &Candidate>,
    mut events: ResMut<'_, EventSink>,
) {
    let roadmap = roadmap.view();
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

/// Sends a [`Feedback`] where one is due and the host listens. Run it once the ending is decided.
pub fn report_feedback(
    model: Res<'_, PlanningModel>,
    settings: Res<'_, SearchSettings>,
    counter: Res<'_, StepCounter>,
    ending: Res<'_, Ending>,
    transitions: Query<'_, '_, (&TransitionId, &TransitionStatistics)>,
    states: Query<'_, '_, (&StateId, &StateStatistics)>,
    mut events: ResMut<'_, EventSink>,
) {
    let interval = settings.feedback_interval;
    let due = ending.0.is_some() || (interval > 0 && counter.step.is_multiple_of(interval));
    if due && events.is_open() {
        let transitions = tried(&model, transitions.iter());
        let states = reached(states.iter());
        events.send(SearchEvent::Feedback(Box::new(Feedback { step: counter.step, transitions, states })));
    }
}

fn tried<'a>(
    model: &PlanningModel,
    all: impl Iterator<Item = (&'a TransitionId, &'a TransitionStatistics)>,
) -> Vec<TransitionFeedback> {
    let mut tried: Vec<_> = all.filter(|(_, s)| s.attempts > 0).collect();
    tried.sort_by_key(|(id, s)| (std::cmp::Reverse(s.attempts), **id));
    tried.truncate(MOST_TRANSITIONS);
    let row = |(id, s): (&TransitionId, &TransitionStatistics)| TransitionFeedback {
        transition: *id,
        attempts: s.attempts,
        reached: s.reached,
        partial: s.partial,
        success_rate: s.success_rate(Prior::default()),
        projection_rate: s.projection_rate(Prior::default()),
        most_blocking: s.blocking_parts(&model.problem.robot).first().copied(),
    };
    tried.into_iter().map(row).collect()
}

fn reached<'a>(all: impl Iterator<Item = (&'a StateId, &'a StateStatistics)>) -> Vec<(StateId, StateStatistics)> {
    let mut reached: Vec<_> = all.filter(|(_, s)| s.nodes > 0).map(|(id, s)| (*id, *s)).collect();
    reached.sort_by_key(|&(id, s)| (std::cmp::Reverse(s.nodes), id));
    reached.truncate(MOST_STATES);
    reached.sort_by_key(|&(id, _)| id);
    reached
}
