//! The facade: a problem in, a certified path or a reason out. `trajectory` answers what a robot program asks of the path. `error` is one error
//! for all that a host asks. `search_record` is what is kept of a search that is to be recorded, `recording` its file; `save` writes the path's.

pub(crate) mod answer;
pub(crate) mod error;
pub(crate) mod object_tries;
#[cfg(feature = "scene")]
pub mod recording;
pub(crate) mod refinement;
pub(crate) mod report;
#[cfg(feature = "scene")]
pub(crate) mod save;
pub(crate) mod search_record;
pub(crate) mod solving;
pub mod trajectory;

pub use crate::planner::answer::{NoSolution, NoSolutionReason, Solution, outcome_name};
pub use crate::planner::error::Error;
pub use crate::planner::object_tries::ObjectTries;
pub use crate::planner::refinement::{BetterPath, CostRow, ImprovementReport, KeptPath};
pub use crate::planner::report::{FunnelRow, GoalReport, Report, StateRow};
pub use crate::planner::search_record::{
    DEFAULT_RECORDING_BYTES, EdgeKind, RecordedEdges, RecordedNodes, SearchRecord,
};
pub use crate::planner::solving::{Planner, panic_message};
pub use crate::planner::trajectory::{Trajectory, TrajectoryError};
