//! How extensions and searches end, with reasons (P0 §III-A asks for this feedback; HPP keeps part of it).

use crate::robot::ShapeIndex;
use std::collections::BTreeMap;

/// Why a candidate gave no motion, or only part of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Rejection {
    /// The chosen tree has no node to extend.
    NoNode,
    /// No transition with positive weight leaves the node's state.
    NoTransition,
    /// Nobody else has reached a leaf that a crossed transition could aim at.
    NoLeafToAimAt,
    /// The projection of a waypoint did not converge (number of the leg).
    ProjectionFailed(u8),
    /// A waypoint that the projection found has an object outside its bounds (number of the leg).
    OutOfBounds(u8),
    /// A waypoint that the projection found is in collision (number of the leg).
    WaypointBlocked(u8),
    /// A leg could not be kept on its leaf up to its waypoint (number of the leg); what comes before may be kept.
    SteeringFailed(u8),
    /// A leg collides, or may collide, before it has moved (number of the leg).
    MotionBlocked(u8),
    /// The target is where the node is already.
    NoProgress,
    /// The search was stopped while the candidate was under way.
    Stopped,
}

impl Rejection {
    /// The reason in words, without the leg.
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Self::NoNode => "no node to extend",
            Self::NoTransition => "no transition leaves the state",
            Self::NoLeafToAimAt => "no leaf of another tree to aim at",
            Self::ProjectionFailed(_) => "projection did not converge",
            Self::OutOfBounds(_) => "object out of its bounds",
            Self::WaypointBlocked(_) => "waypoint in collision",
            Self::SteeringFailed(_) => "motion left its leaf",
            Self::MotionBlocked(_) => "motion in collision",
            Self::NoProgress => "no progress",
            Self::Stopped => "stopped",
        }
    }

    /// Number of the leg it happened on, where it happened on one.
    #[must_use]
    pub fn leg(self) -> Option<u8> {
        match self {
            Self::ProjectionFailed(leg)
            | Self::OutOfBounds(leg)
            | Self::WaypointBlocked(leg)
            | Self::SteeringFailed(leg)
            | Self::MotionBlocked(leg) => Some(leg),
            Self::NoNode | Self::NoTransition | Self::NoLeafToAimAt | Self::NoProgress | Self::Stopped => None,
        }
    }
}

/// What became of the candidates that tried a transition.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct TransitionStatistics {
    /// Candidates that chose the transition.
    pub attempts: u64,
    /// Candidates that reached the transition's target.
    pub reached: u64,
    /// Candidates of which a part was kept.
    pub partial: u64,
    /// Candidates of which nothing was kept, and partial ones with what stopped them, by reason.
    pub rejections: BTreeMap<Rejection, u64>,
    /// Pairs of shapes that stopped candidates, and how often.
    pub blocked_by: BTreeMap<(ShapeIndex, ShapeIndex), u64>,
}

impl TransitionStatistics {
    /// Counts the end of a candidate.
    pub fn count_rejection(&mut self, reason: Rejection, blocked_by: Option<(ShapeIndex, ShapeIndex)>) {
        *self.rejections.entry(reason).or_default() += 1;
        if let Some(pair) = blocked_by {
            *self.blocked_by.entry(pair).or_default() += 1;
        }
    }
}

/// How a search ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SearchOutcome {
    /// Start and a goal hang together.
    Solved,
    /// The deadline passed first.
    Timeout,
    /// The budget of steps was spent.
    StepLimit,
    /// The host cancelled.
    Cancelled,
    /// The roadmap outgrew its budget of memory.
    MemoryLimit,
    /// The start is out of bounds, in collision or in no state; why.
    InfeasibleStart(String),
    /// No goal is usable; why.
    InfeasibleGoal(String),
}

impl SearchOutcome {
    /// The outcome's name in results: `solved`, `timeout`, …
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Timeout => "timeout",
            Self::StepLimit => "step_limit",
            Self::Cancelled => "cancelled",
            Self::MemoryLimit => "memory_limit",
            Self::InfeasibleStart(_) => "infeasible_start",
            Self::InfeasibleGoal(_) => "infeasible_goal",
        }
    }
}
