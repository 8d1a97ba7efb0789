//! What a solve has answered, as the commands tell it: path or not, they print the same columns.

use crate::components::path::ManipulationPath;
use crate::systems::planning_model::PlanningModel;
use crate::systems::search::path_clearance::PathClearance;
use crate::{NoSolution, NoSolutionReason, Report, Solution, planner};

/// A path, or why there is none.
pub(crate) struct Answer(pub Result<Solution, NoSolution>);

impl Answer {
    /// `solved`, or the name of the reason.
    pub(crate) fn name(&self) -> &'static str {
        planner::outcome_name(&self.0)
    }

    pub(crate) fn reason(&self) -> Option<&NoSolutionReason> {
        self.0.as_ref().err().map(|none| &none.reason)
    }

    pub(crate) fn path(&self) -> Option<&ManipulationPath> {
        self.0.as_ref().ok().map(|solution| &solution.path)
    }

    pub(crate) fn report(&self) -> &Report {
        Report::of(&self.0)
    }

    pub(crate) fn model(&self) -> &PlanningModel {
        match &self.0 {
            Ok(solution) => &solution.model,
            Err(none) => &none.model,
        }
    }

    /// Measures how close things come, where there is a path; its certificate says that from then on.
    pub(crate) fn measure_clearance(&mut self) -> Option<PathClearance> {
        self.0.as_mut().ok()?.measure_clearance()
    }
}
