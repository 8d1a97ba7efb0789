//! What most hosts name: `use foliate::prelude::*;`.

pub use crate::os::memory::MemoryLimit;
pub use crate::planner::error::Error;
pub use crate::planner::trajectory::{JointSample, Trajectory, TrajectoryError};
pub use crate::planner::{NoSolution, NoSolutionReason, Planner, Report, Solution};
#[cfg(feature = "scene")]
pub use crate::scene::{PackagePath, Scene, SceneError};
pub use foliate_components::Pose;
pub use foliate_components::infeasibility::Infeasibility;
pub use foliate_components::path::{Certificate, EventKind, ManipulationPath as Path};
pub use foliate_components::problem::{Goal, PartialGoal, Problem};
pub use foliate_components::robot::{CoordinateError, CoordinateValue};
pub use foliate_systems::events::{CancelToken, SearchEvent, SolveEvent, SolveId};
pub use foliate_systems::settings::SearchSettings;
