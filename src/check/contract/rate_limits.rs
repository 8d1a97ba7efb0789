//! Limits of rates and dwells are the scene's.

use crate::check::contract::scene_contract::{Contract, differs};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::kind::Kind;
use crate::path_file::document::PathFile;
use foliate_components::problem::RateLimits;

/// Rounding of limits, as a share of them, and of dwells, seconds.
const SLACK: f64 = 1e-9;

impl Contract<'_> {
    /// No limit of a file is larger than the scene's, and none is missing.
    pub(super) fn rate_limits(&self, file: &PathFile, report: &mut CheckReport) {
        let Some(table) = &file.rate_limits else { return };
        let scene = RateLimits::of(&self.problem.robot, &self.problem.timing);
        for (index, name) in self.names.iter().enumerate() {
            let said = table.get(name).copied().unwrap_or_default();
            for (what, said, limit) in [
                ("velocity", said.velocity, scene.velocity[index]),
                ("acceleration", said.acceleration, scene.acceleration[index]),
                ("jerk", said.jerk, scene.jerk[index]),
            ] {
                match said {
                    None if limit.is_finite() => {
                        differs(
                            report,
                            format!("the {what} limit of `{name}` is not in the file, in the scene it is {limit}"),
                        );
                    }
                    Some(said) if said > limit * (1.0 + SLACK) => {
                        differs(report, format!("the {what} limit of `{name}` is {said}, in the scene {limit}"));
                    }
                    Some(said) if said < limit * (1.0 - SLACK) => {
                        report.note(format!("the {what} limit of {name} is {said}, in the scene {limit}"));
                    }
                    _ => {}
                }
            }
        }
        let dwell = self.problem.timing.dwell;
        for event in file.events.iter().flatten().filter(|event| event.dwell < dwell - SLACK) {
            let subject = "a dwell is shorter than the scene's";
            report.violate(Place::at(event.segment, 0.0), Kind::Demand, subject, event.dwell, dwell);
        }
    }
}
