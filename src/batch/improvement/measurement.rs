//! What a batch spends on better paths, and when it looks at them.

use crate::planner::solving::Planner;
use std::fmt;
use std::time::Duration;

/// How much a solve spends on a better path than the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    /// Counted work: see [`Planner::improve_work`].
    Work(u64),
    /// Wall time: see [`Planner::improve_time`].
    Time(Duration),
}

/// Milliseconds of improvement after which a measurement looks at the path, unless it is told others.
const CHECKPOINTS: [u64; 3] = [100, 1_000, 10_000];

/// Makes a batch improve every first path, and look at the path while it gets better: in the beginning, at checkpoints and in the end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Measurement {
    budget: Budget,
    checkpoints: Vec<Duration>,
}

impl Measurement {
    /// With checkpoints after 0.1, 1 and 10 seconds, as far as the budget reaches.
    #[must_use]
    pub fn new(budget: Budget) -> Self {
        Self { budget, checkpoints: Vec::new() }.checkpoints(CHECKPOINTS.map(Duration::from_millis))
    }

    /// With other checkpoints: wall times since the improvement began. The first path and the end are looked at in any case. Checkpoints
    /// that a budget of time does not reach are left out.
    #[must_use]
    pub fn checkpoints(mut self, checkpoints: impl IntoIterator<Item = Duration>) -> Self {
        let is_within = |time: &Duration| match self.budget {
            Budget::Work(_) => true,
            Budget::Time(budget) => *time < budget,
        };
        self.checkpoints = checkpoints.into_iter().filter(|time| !time.is_zero() && is_within(time)).collect();
        self.checkpoints.sort_unstable();
        self.checkpoints.dedup();
        self
    }

    /// How much is spent.
    #[must_use]
    pub fn budget(&self) -> Budget {
        self.budget
    }

    /// The checkpoints between the first path and the end, in order.
    #[must_use]
    pub fn times(&self) -> &[Duration] {
        &self.checkpoints
    }

    /// A planner that spends the budget.
    pub(crate) fn apply(&self, planner: Planner) -> Planner {
        match self.budget {
            Budget::Work(work) => planner.improve_work(work),
            Budget::Time(time) => planner.improve_time(time),
        }
    }

    /// Whether an improvement has had its budget.
    pub(crate) fn is_spent(&self, work: u64, time: Duration) -> bool {
        match self.budget {
            Budget::Work(budget) => work >= budget,
            Budget::Time(budget) => time >= budget,
        }
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Work(work) => write!(f, "work {work}"),
            Self::Time(time) => write!(f, "{} s", time.as_secs_f64()),
        }
    }
}

/// The budget and the checkpoints: rows of two measurements do not go together.
impl fmt::Display for Measurement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let times: Vec<String> = self.checkpoints.iter().map(|time| time.as_secs_f64().to_string()).collect();
        write!(f, "{}, checkpoints {}", self.budget, times.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::{Budget, Measurement};
    use std::time::Duration;

    #[test]
    fn checkpoints_are_sorted_and_lie_within_the_budget() {
        let seconds = Duration::from_secs;
        let of = |budget| Measurement::new(budget).checkpoints([5, 1, 0, 3, 1].map(seconds));
        assert_eq!(of(Budget::Work(7)).times(), [1, 3, 5].map(seconds));
        assert_eq!(of(Budget::Time(seconds(5))).times(), [1, 3].map(seconds));
        assert_eq!(Measurement::new(Budget::Time(seconds(1))).to_string(), "1 s, checkpoints 0.1");
    }
}
