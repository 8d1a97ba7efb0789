//! The facade: a problem in, a certified path or a reason out.

pub(crate) mod answer;
pub(crate) mod refinement;
pub(crate) mod report;
pub(crate) mod solving;

pub use crate::planner::answer::{NoSolution, NoSolutionReason, Solution, outcome_name};
pub use crate::planner::refinement::{BetterPath, CostRow, ImprovementReport};
pub use crate::planner::report::{FunnelRow, GoalReport, Report, StateRow};
pub use crate::planner::solving::Planner;
