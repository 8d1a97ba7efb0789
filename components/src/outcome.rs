//! How extensions and searches end, with reasons (P0 §III-A asks for this feedback; HPP keeps part of it).

use crate::infeasibility::Infeasibility;
use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{PartIndex, ShapeIndex};
use std::collections::BTreeMap;

/// Why a candidate gave no motion, or only part of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Rejection {
    /// The chosen tree has no node to extend.
    NoNode,
    /// No transition with positive weight leaves the node's state.
    NoTransition,
    /// No other tree has reached a leaf that a crossed transition could aim at.
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
    /// The scheduler had nothing for it to do in this step.
    LeftOut,
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
            Self::LeftOut => "left out of the step",
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
            Self::NoNode
            | Self::NoTransition
            | Self::NoLeafToAimAt
            | Self::NoProgress
            | Self::Stopped
            | Self::LeftOut => None,
        }
    }
}

/// What is believed of a rate before anything was tried: as if `successes` of `attempts` had succeeded already.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Imagined successes.
    pub successes: f64,
    /// Imagined attempts; more of them make the rate trust its counts later.
    pub attempts: f64,
}

impl Default for Prior {
    /// Laplace's rule of succession: one success in two attempts.
    fn default() -> Self {
        Self { successes: 1.0, attempts: 2.0 }
    }
}

impl Prior {
    /// The rate after `successes` of `attempts`, in [0, 1] where the prior's own is.
    #[must_use]
    pub fn rate(self, successes: u64, attempts: u64) -> f64 {
        (successes as f64 + self.successes) / (attempts as f64 + self.attempts)
    }
}

/// Tries of a transition on one search side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SideTries {
    /// Candidates that chose the transition; those that found nothing to aim at or were stopped do not count.
    pub tries: u64,
    /// Those that reached its target.
    pub reached: u64,
    /// Those for which no configuration of the robot was found.
    pub out_of_reach: u64,
    /// Those that collided.
    pub in_collision: u64,
}

impl SideTries {
    /// Counts the end of a candidate; `None` where it reached the target.
    pub fn count(&mut self, rejected: Option<Rejection>) {
        match rejected {
            Some(Rejection::NoLeafToAimAt | Rejection::Stopped) => return,
            Some(Rejection::ProjectionFailed(_)) => self.out_of_reach += 1,
            Some(Rejection::WaypointBlocked(_) | Rejection::MotionBlocked(_)) => self.in_collision += 1,
            Some(_) => {}
            None => self.reached += 1,
        }
        self.tries += 1;
    }
}

impl std::ops::AddAssign for SideTries {
    fn add_assign(&mut self, other: Self) {
        self.tries += other.tries;
        self.reached += other.reached;
        self.out_of_reach += other.out_of_reach;
        self.in_collision += other.in_collision;
    }
}

/// What became of the candidates that tried a transition.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct TransitionStatistics {
    /// Candidates that chose the transition; of a loop also the motions that were tried when blocked ones were planned.
    pub attempts: u64,
    /// Candidates that reached the transition's target. A lazily extended one counts until its motions are known not to be free.
    pub reached: u64,
    /// Candidates of which a part was kept.
    pub partial: u64,
    /// Candidates of which nothing was kept, and partial ones with what stopped them, by reason.
    pub rejections: BTreeMap<Rejection, u64>,
    /// Pairs of shapes that stopped candidates, and how often.
    pub blocked_by: BTreeMap<(ShapeIndex, ShapeIndex), u64>,
    /// The candidates that extended trees of the start's side, and those of the goals' side.
    pub sides: [SideTries; 2],
}

impl TransitionStatistics {
    /// Counts the end of a candidate.
    pub fn count_rejection(&mut self, reason: Rejection, blocked_by: Option<(ShapeIndex, ShapeIndex)>) {
        *self.rejections.entry(reason).or_default() += 1;
        if let Some(pair) = blocked_by {
            *self.blocked_by.entry(pair).or_default() += 1;
        }
    }

    /// How often a candidate reaches the target: the action's success rate (P0 §III-A).
    #[must_use]
    pub fn success_rate(&self, prior: Prior) -> f64 {
        prior.rate(self.reached, self.attempts)
    }

    /// How often the waypoints of a candidate that came so far could be projected (P0 §III-A): low where the action is
    /// geometrically hard whatever stands around.
    #[must_use]
    pub fn projection_rate(&self, prior: Prior) -> f64 {
        let count = |which: fn(&Rejection) -> bool| {
            self.rejections.iter().filter(|(reason, _)| which(reason)).map(|(_, n)| n).sum::<u64>()
        };
        let failed = count(|reason| matches!(reason, Rejection::ProjectionFailed(_)));
        let untried = count(|reason| matches!(reason, Rejection::NoLeafToAimAt | Rejection::Stopped));
        let tried = self.attempts.saturating_sub(untried);
        prior.rate(tried.saturating_sub(failed), tried)
    }

    /// Pairs of parts that stopped candidates, most frequent first: which object is in the way of the transition.
    #[must_use]
    pub fn blocking_parts(&self, robot: &Robot) -> Vec<BlockingParts> {
        by_parts(&self.blocked_by, robot)
    }
}

/// Two parts, and how often shapes of them stopped something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockingParts {
    /// One part; never greater than the other.
    pub first: PartIndex,
    /// The other; the same where a part collides with itself.
    pub second: PartIndex,
    /// How often.
    pub count: u64,
}

/// Sums counts by pairs of shapes into counts by pairs of parts: the most frequent first, ties by part.
fn by_parts(pairs: &BTreeMap<(ShapeIndex, ShapeIndex), u64>, robot: &Robot) -> Vec<BlockingParts> {
    let part = |shape: ShapeIndex| robot.links[robot.shapes[shape.at()].link.at()].part;
    let mut counts = BTreeMap::<(PartIndex, PartIndex), u64>::new();
    for (&(a, b), count) in pairs {
        let (a, b) = (part(a), part(b));
        *counts.entry((a.min(b), a.max(b))).or_default() += count;
    }
    let mut sums: Vec<_> =
        counts.into_iter().map(|((first, second), count)| BlockingParts { first, second, count }).collect();
    sums.sort_by_key(|pair| std::cmp::Reverse(pair.count));
    sums
}

/// What the search has of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct StateStatistics {
    /// Roadmap nodes in it, roots included.
    pub nodes: u64,
    /// Leaves of it that have been reached.
    pub leaves: u64,
    /// Candidates that started from a node in it.
    pub extended: u64,
    /// Motions in it that were tried between two trees (P1 Alg. 3).
    pub connections_tried: u64,
    /// Those of them that joined two trees.
    pub connections_made: u64,
}

/// What became of the tries to find configurations for goals that leave something free.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GoalStatistics {
    /// Configurations that were tried.
    pub tries: u64,
    /// Configurations that became goals.
    pub found: u64,
    /// Projections onto a state and the goal that did not converge.
    pub projection_failed: u64,
    /// Configurations that lay outside some bounds, or in no state.
    pub refused: u64,
    /// Pairs of shapes that collided, and how often.
    pub blocked_by: BTreeMap<(ShapeIndex, ShapeIndex), u64>,
}

impl GoalStatistics {
    /// Pairs of parts that collided in configurations for a goal, most frequent first.
    #[must_use]
    pub fn blocking_parts(&self, robot: &Robot) -> Vec<BlockingParts> {
        by_parts(&self.blocked_by, robot)
    }
}

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub enum SearchOutcome {
    /// Start and a goal are connected.
    Solved,
    /// The deadline passed first.
    Timeout,
    /// The budget of steps was spent.
    StepLimit,
    /// The host cancelled.
    Cancelled,
    /// The roadmap outgrew its budget of memory.
    MemoryLimit,
    /// The start is out of bounds, in collision or in no state.
    InfeasibleStart(Infeasibility),
    /// No goal is usable.
    InfeasibleGoal(Infeasibility),
    /// Something in the search panicked, which is a bug of ours or of a system of the host's; what it said.
    Crashed(String),
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
            Self::Crashed(_) => "crashed",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_start_at_the_prior_and_follow_the_counts() {
        let mut s = TransitionStatistics::default();
        assert_eq!(s.success_rate(Prior::default()), 0.5);
        (s.attempts, s.reached) = (8, 2);
        for _ in 0..3 {
            s.count_rejection(Rejection::ProjectionFailed(0), None);
        }
        s.count_rejection(Rejection::NoLeafToAimAt, None);
        s.count_rejection(Rejection::MotionBlocked(1), Some((ShapeIndex(0), ShapeIndex(1))));
        assert_eq!(s.success_rate(Prior::default()), 3.0 / 10.0);
        // One never came to projecting; of the other seven four were projected.
        assert_eq!(s.projection_rate(Prior { successes: 0.0, attempts: 0.0 }), 4.0 / 7.0);
    }
}
