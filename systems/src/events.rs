//! What a running search tells its host, through a bounded channel that never blocks the search.

use bevy_ecs::prelude::Resource;
use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::{BlockingParts, Rejection, SearchOutcome, StateStatistics};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Which solve of a planner an event or an answer is of; numbered from 0 in the order in which the solves begin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SolveId(pub u64);

impl std::fmt::Display for SolveId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// An event, and the solve that it is of: solves that run side by side may share one channel.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SolveEvent {
    /// The solve.
    pub solve: SolveId,
    /// What happened.
    pub event: SearchEvent,
}

/// Something a host may want to know while a search runs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SearchEvent {
    /// A step has ended.
    Progress {
        /// Steps so far.
        step: u64,
        /// Candidates so far.
        candidates: u64,
        /// Roadmap nodes.
        nodes: usize,
        /// Roadmap edges.
        edges: usize,
        /// Leaves reached.
        leaves: usize,
    },
    /// A candidate was dropped.
    Rejected {
        /// The step.
        step: u64,
        /// The transition that it tried, where it came that far.
        transition: Option<TransitionId>,
        /// Why.
        reason: Rejection,
    },
    /// How the transitions fare, every [`crate::settings::SearchSettings::feedback_interval`] steps and at the end.
    Feedback(Box<Feedback>),
    /// A goal is connected with the start.
    Solved {
        /// The step.
        step: u64,
    },
}

/// The search's end of the channel. When the host does not read, events are dropped and counted.
#[derive(Clone, Debug, Default, Resource)]
pub struct EventSink {
    sender: Option<Sender<SolveEvent>>,
    solve: SolveId,
    /// Events that found the channel full.
    pub dropped: u64,
}

impl EventSink {
    /// A sink and the host's end, which holds at most `capacity` unread events.
    #[must_use]
    pub fn bounded(capacity: usize) -> (Self, Receiver<SolveEvent>) {
        let (sender, receiver) = bounded(capacity);
        (Self { sender: Some(sender), solve: SolveId::default(), dropped: 0 }, receiver)
    }

    /// The same sink for the events of a solve.
    #[must_use]
    pub fn of_solve(&self, solve: SolveId) -> Self {
        Self { solve, ..self.clone() }
    }

    /// The solve whose events it sends.
    #[must_use]
    pub fn solve(&self) -> SolveId {
        self.solve
    }

    /// Whether anybody listens.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.sender.is_some()
    }

    /// Sends without ever waiting.
    pub fn send(&mut self, event: SearchEvent) {
        let event = SolveEvent { solve: self.solve, event };
        match self.sender.as_ref().map(|s| s.try_send(event)) {
            Some(Err(TrySendError::Full(_))) => self.dropped += 1,
            Some(Err(TrySendError::Disconnected(_))) => self.sender = None,
            Some(Ok(())) | None => {}
        }
    }
}

/// Cancels a search from any thread.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// A token that is also cancelled by setting a flag, as a handler of signals does.
    #[must_use]
    pub fn of_flag(flag: Arc<AtomicBool>) -> Self {
        Self(flag)
    }

    /// Asks every search that holds the token to stop.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether a stop was requested.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The host's own watch over the memory of its process: whether there is too much of it. What it has said once it goes on to say.
#[derive(Clone)]
pub struct MemoryGuard(Arc<dyn Fn() -> bool + Send + Sync>);

impl MemoryGuard {
    /// `is_exceeded` is asked often, from any thread, before each candidate in every stage. As with a deadline, it may only turn an
    /// answer into none.
    #[must_use]
    pub fn new(is_exceeded: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        let said = AtomicBool::new(false);
        Self(Arc::new(move || {
            if !said.load(Ordering::Relaxed) && is_exceeded() {
                said.store(true, Ordering::Relaxed);
            }
            said.load(Ordering::Relaxed)
        }))
    }
}

impl std::fmt::Debug for MemoryGuard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("MemoryGuard")
    }
}

/// The deadline and the token; every stage checks both before each candidate.
#[derive(Clone, Debug, Default, Resource)]
pub struct StopSignal {
    /// When to give up.
    pub deadline: Option<Instant>,
    /// The host's token.
    pub token: CancelToken,
    /// The host's watch over memory.
    pub memory: Option<MemoryGuard>,
}

impl StopSignal {
    /// Whether to stop. A clock may only turn an answer into none, never choose among answers.
    #[must_use]
    pub fn is_raised(&self) -> bool {
        self.token.is_cancelled() || self.deadline.is_some_and(|d| Instant::now() >= d) || self.is_out_of_memory()
    }

    /// How a search ends now that it is to stop; `None` while it may go on. What a step found after the signal was raised is no
    /// answer, even if it solves the problem: another run would have found another.
    #[must_use]
    pub fn outcome(&self) -> Option<SearchOutcome> {
        if self.token.is_cancelled() {
            Some(SearchOutcome::Cancelled)
        } else if self.is_out_of_memory() {
            Some(SearchOutcome::MemoryLimit)
        } else if self.is_raised() {
            Some(SearchOutcome::Timeout)
        } else {
            None
        }
    }

    /// Whether the host's watch over memory says so.
    #[must_use]
    pub fn is_out_of_memory(&self) -> bool {
        self.memory.as_ref().is_some_and(|guard| (guard.0)())
    }
}

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
    /// [`TransitionStatistics::success_rate`](foliate_components::outcome::TransitionStatistics::success_rate) with the default prior.
    pub success_rate: f64,
    /// [`TransitionStatistics::projection_rate`](foliate_components::outcome::TransitionStatistics::projection_rate)
    /// with the default prior.
    pub projection_rate: f64,
    /// The parts that were most often in each other's way.
    pub most_blocking: Option<BlockingParts>,
}

/// Largest number of transitions in a report, a bound on what an unread channel holds.
pub const MOST_TRANSITIONS: usize = 256;

/// Largest number of states in a report.
pub const MOST_STATES: usize = 256;
