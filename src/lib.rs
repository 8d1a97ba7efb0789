#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

#[cfg(feature = "scene")]
pub mod batch;
#[cfg(feature = "check")]
pub mod certify;
#[cfg(feature = "check")]
pub mod check;
#[cfg(feature = "cli")]
pub mod cli;
pub mod inspection;
mod os;
#[cfg(feature = "scene")]
pub mod path_file;
pub mod planner;
pub mod prelude;
#[cfg(feature = "scene")]
pub mod scene;
#[cfg(feature = "scene")]
pub mod setup;
#[cfg(feature = "view")]
pub mod view;

pub use crate::os::memory;
#[cfg(feature = "scene")]
pub use crate::os::output;
#[cfg(feature = "export")]
pub use crate::path_file::export;
#[cfg(feature = "scene")]
pub use crate::planner::recording;
pub use crate::planner::{
    Error, FunnelRow, GoalReport, NoSolution, NoSolutionReason, ObjectTries, Planner, Report, Solution, StateRow,
    Trajectory, TrajectoryError, trajectory,
};
// Crates whose types stand in the signatures of this one: a host that uses these needs no versions of its own.
#[cfg(feature = "urdf-rs")]
pub use urdf_rs;
pub use {bevy_ecs, crossbeam_channel, glam, glamx};
pub use {
    foliate_components as components, foliate_kernels as kernels, foliate_schedulers as schedulers,
    foliate_systems as systems,
};

/// The code of the guide compiles.
#[cfg(doctest)]
#[doc = include_str!("../docs/own-scheduler.md")]
struct OwnSchedulerGuide;

/// The code of the page about batches runs.
#[cfg(all(doctest, feature = "scene"))]
#[doc = include_str!("../docs/batches.md")]
struct BatchesGuide;
