//! What a task planner learns while a search runs (P0 §III-A): numbers that the geometry gives its symbols.
//!
//! The figures themselves are components: [`TransitionStatistics`] on the transitions' entities and [`StateStatistics`] on
//! the states', counted by the commit. A system of a scheduler's own reads them there; a host that does not live in the
//! world gets them as a [`Feedback`] every so many steps. They are counts, never times, so whoever decides by them stays
//! deterministic.

use crate::conclusion::Ending;
use crate::events::{EventSink, SearchEvent};
use crate::model::PlanningModel;
use crate::schedule::StepCounter;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::{Query, Res, ResMut};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::{BlockingParts, Prior, StateStatistics, TransitionStatistics};

/// A report on a search under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Feedback {
    /// Steps so far.
    pub step: u64,
    /// Transitions that were tried, most often tried first, then by id; at most [`MOST_TRANSITIONS`].
    pub transitions: Vec<TransitionFeedback>,
    /// States in which the roadmap has nodes, by id; at most [`MOST_STATES`], those with most nodes.
    pub states: Vec<(StateId, StateStatistics)>,
}

/// How one transition fares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransitionFeedback {
    /// Which.
    pub transition: TransitionId,
    /// Candidates that tried it.
    pub attempts: u64,
    /// Candidates that reached its target.
    pub reached: u64,
    /// Candidates of which a part was kept.
    pub partial: u64,
    /// [`TransitionStatistics::success_rate`] with the default prior.
    pub success_rate: f64,
    /// [`TransitionStatistics::projection_rate`] with the default prior.
    pub projection_rate: f64,
    /// The parts that were most often in each other's way.
    pub most_blocking: Option<BlockingParts>,
}

/// Largest number of transitions in a report, a bound on what an unread channel holds.
pub const MOST_TRANSITIONS: usize = 256;

/// Largest number of states in a report.
pub const MOST_STATES: usize = 256;

/// Sends a [`Feedback`] where one is due and somebody listens. Run it once the ending is decided.
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
