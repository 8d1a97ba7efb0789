//! What a solve answers: a certified path, or why there is none.

use crate::planner::report::Report;
use crate::planner::search_record::SearchRecord;
use crate::planner::trajectory::curve::Interpolation;
use crate::planner::trajectory::error::TrajectoryError;
use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::infeasibility::Infeasibility;
use foliate_components::outcome::SearchOutcome;
use foliate_components::path::{Certificate, ManipulationPath};
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::path_clearance::{PathClearance, path_clearance};
use std::fmt;
use std::sync::Arc;

/// A certified path, and what the search did to find it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solution {
    /// The path from the start to a goal, with its certificate.
    pub path: ManipulationPath,
    /// What the search did.
    pub report: Report,
    /// The model whose graph the path's ids are of: the planner's own, or, where its graph is lazy, as far as this search has
    /// made it grow.
    pub model: PlanningModel,
    /// What is kept of the search, where the planner was asked to record ([`Planner::record`](crate::Planner::record)).
    pub record: Option<Arc<SearchRecord>>,
}

impl Solution {
    /// What is proven about the path.
    #[must_use]
    pub fn certificate(&self) -> &Certificate {
        &self.path.certificate
    }

    /// What a robot program asks of the path: joints, poses and what is held at any time, and when hands take and let go.
    ///
    /// # Errors
    /// [`TrajectoryError::NoTimes`] where the path has no times.
    pub fn trajectory(&self) -> Result<Trajectory<'_>, TrajectoryError> {
        let states = self.path.segments.iter().map(|s| self.model.graph.state(s.state).name.as_str()).collect();
        Trajectory::new(&self.model.problem.robot, &self.path, states, Interpolation::Hermite)
    }

    /// How close things come along the path, and where: of all tested pairs of shapes the least distance beyond the margins, bounded
    /// from below to within a tenth of it or 0.1 mm. `None` where no pair is tested.
    ///
    /// The search proves no more than that nothing touches, and that is what the path's certificate says at first; this takes
    /// milliseconds on top.
    #[must_use]
    pub fn clearance(&self) -> Option<PathClearance> {
        path_clearance(&self.model, &self.path)
    }

    /// As [`Self::clearance`], and from then on the path's certificate says the better bound.
    pub fn measure_clearance(&mut self) -> Option<PathClearance> {
        let found = self.clearance()?;
        self.path.certificate.min_clearance = Some(found.lower);
        Some(found)
    }
}

/// Why a solve gave no path, and what the search did.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct NoSolution {
    /// Why.
    pub reason: NoSolutionReason,
    /// What the search did; empty where it crashed or did not begin.
    pub report: Box<Report>,
    /// The model whose graph the report names: the planner's own, or, where its graph is lazy, as far as this search has made it
    /// grow.
    pub model: PlanningModel,
    /// What is kept of the search, where the planner was asked to record ([`Planner::record`](crate::Planner::record)); none where it
    /// crashed or did not begin.
    pub record: Option<Arc<SearchRecord>>,
}

/// Why a solve gave no path.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum NoSolutionReason {
    /// The time limit passed first.
    TimeLimit,
    /// The budget of steps was spent.
    StepLimit,
    /// The search needed more memory than it may have, or its process has more.
    MemoryLimit,
    /// The host cancelled.
    Cancelled,
    /// The start cannot be planned from.
    InfeasibleStart(Infeasibility),
    /// No goal can be planned to.
    InfeasibleGoal(Infeasibility),
    /// Something in the search panicked, which is a bug of Foliate or of a system of the host's; what it said.
    Crashed(String),
    /// The operating system refused the threads.
    Threads {
        /// How many were wanted.
        wanted: usize,
        /// The refusal.
        error: Arc<rayon::ThreadPoolBuildError>,
    },
    /// The search joined start and goal, but no path could be extracted, which is a bug of Foliate.
    NoPath,
}

impl NoSolutionReason {
    /// The reason of a search that has ended; [`Self::NoPath`] of one that is solved.
    pub(crate) fn of(outcome: SearchOutcome) -> Self {
        match outcome {
            SearchOutcome::Solved => Self::NoPath,
            SearchOutcome::Timeout => Self::TimeLimit,
            SearchOutcome::StepLimit => Self::StepLimit,
            SearchOutcome::MemoryLimit => Self::MemoryLimit,
            SearchOutcome::Cancelled => Self::Cancelled,
            SearchOutcome::InfeasibleStart(why) => Self::InfeasibleStart(why),
            SearchOutcome::InfeasibleGoal(why) => Self::InfeasibleGoal(why),
            SearchOutcome::Crashed(why) => Self::Crashed(why),
        }
    }

    /// The reason's name in results: `timeout`, `step_limit`, …
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::TimeLimit => "timeout",
            Self::StepLimit => "step_limit",
            Self::MemoryLimit => "memory_limit",
            Self::Cancelled => "cancelled",
            Self::InfeasibleStart(_) => "infeasible_start",
            Self::InfeasibleGoal(_) => "infeasible_goal",
            Self::Crashed(_) => "crashed",
            Self::Threads { .. } | Self::NoPath => "failed",
        }
    }

    /// Whether start or goal are infeasible, so that nothing was searched in vain.
    #[must_use]
    pub fn is_infeasible(&self) -> bool {
        matches!(self, Self::InfeasibleStart(_) | Self::InfeasibleGoal(_))
    }

    /// What there is to tell beyond the name: why start or goal are infeasible, what a panic said.
    #[must_use]
    pub fn detail(&self) -> Option<String> {
        match self {
            Self::TimeLimit | Self::StepLimit | Self::MemoryLimit | Self::Cancelled => None,
            Self::InfeasibleStart(why) | Self::InfeasibleGoal(why) => Some(why.to_string()),
            Self::Crashed(why) => Some(why.clone()),
            Self::Threads { .. } | Self::NoPath => Some(self.to_string()),
        }
    }
}

impl fmt::Display for NoSolutionReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TimeLimit => f.write_str("the time limit was reached"),
            Self::StepLimit => f.write_str("the step limit was reached"),
            Self::MemoryLimit => f.write_str("the memory limit was reached"),
            Self::Cancelled => f.write_str("the search was cancelled"),
            Self::InfeasibleStart(why) => write!(f, "the start is infeasible: {why}"),
            Self::InfeasibleGoal(why) => write!(f, "the goal is infeasible: {why}"),
            Self::Crashed(why) => write!(f, "the search crashed, which is a bug: {}", why.escape_debug()),
            Self::Threads { wanted, error } => write!(f, "cannot start {wanted} threads: {error}"),
            Self::NoPath => f.write_str("start and goal are connected, but no path was extracted"),
        }
    }
}

impl fmt::Display for NoSolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no solution after {} candidates: {}", self.report.candidates, self.reason)
    }
}

impl std::error::Error for NoSolution {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.reason {
            NoSolutionReason::InfeasibleStart(why) | NoSolutionReason::InfeasibleGoal(why) => Some(why),
            NoSolutionReason::Threads { error, .. } => Some(error.as_ref()),
            _ => None,
        }
    }
}

impl Report {
    /// The report of an answer, whether it is a path or not.
    #[must_use]
    pub fn of(answer: &Result<Solution, NoSolution>) -> &Self {
        match answer {
            Ok(solution) => &solution.report,
            Err(failure) => &failure.report,
        }
    }
}

/// The outcome's name in results: `solved`, or that of the reason ([`NoSolutionReason::name`]).
#[must_use]
pub fn outcome_name(answer: &Result<Solution, NoSolution>) -> &'static str {
    match answer {
        Ok(_) => "solved",
        Err(failure) => failure.reason.name(),
    }
}
