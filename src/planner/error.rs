//! One error for a host that asks the library for several things.

use crate::os::memory::MemoryLimitError;
use crate::planner::answer::NoSolution;
use crate::planner::trajectory::error::TrajectoryError;
use foliate_components::robot::{ComposeError, CoordinateError};
use foliate_systems::planning_model::ModelError;

/// Any error of the library. Each variant displays as the error in it and has that error's source.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Models do not make a robot.
    #[error(transparent)]
    Compose(#[from] ComposeError),
    /// A coordinate cannot be set by its name.
    #[error(transparent)]
    Coordinate(#[from] CoordinateError),
    /// The problem cannot be planned for.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A solve gave no path.
    #[error(transparent)]
    NoSolution(#[from] NoSolution),
    /// A path answers no question about time.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// A text is no amount of memory.
    #[error(transparent)]
    MemoryLimit(#[from] MemoryLimitError),
    /// A scene or a model cannot be read.
    #[cfg(feature = "scene")]
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneError),
    /// A path file cannot be read or written.
    #[cfg(feature = "scene")]
    #[error(transparent)]
    PathFile(#[from] crate::path_file::PathFileError),
    /// A recording cannot be read or written.
    #[cfg(feature = "scene")]
    #[error(transparent)]
    Recording(#[from] crate::recording::RecordingError),
    /// A batch cannot be run.
    #[cfg(feature = "scene")]
    #[error(transparent)]
    Batch(#[from] crate::batch::BatchError),
    /// A path file cannot be checked.
    #[cfg(feature = "check")]
    #[error(transparent)]
    Check(#[from] crate::check::CheckError),
    /// A motion cannot be certified.
    #[cfg(feature = "check")]
    #[error(transparent)]
    Certify(#[from] crate::certify::CertifyError),
}
