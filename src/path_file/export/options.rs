//! What is asked of an export, and why there is none.

use crate::planner::trajectory::error::TrajectoryError;
use crate::scene::reading::error::SceneError;
use std::path::Path;

/// A format for other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Format {
    /// Messages of ROS: YAML where the file's name ends with .yaml or .yml, else JSON
    Ros,
    /// Messages of ROS as JSON: trajectory_msgs/JointTrajectory for each robot, attached objects as in moveit_msgs
    RosJson,
    /// The same as YAML
    RosYaml,
    /// A table with a row for each sample and a column for each coordinate
    Csv,
    /// NumPy arrays: positions, velocities and accelerations of joints, poses of links and objects, events
    Npz,
    /// A recording for Foxglove and Lichtblick: joint states, transforms and events as JSON messages
    Mcap,
    /// An animated glTF scene with the models' meshes
    Glb,
}

impl Format {
    /// The format of files that are called so.
    #[must_use]
    pub fn of_name(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "json" => Some(Self::RosJson),
            "yaml" | "yml" => Some(Self::RosYaml),
            "csv" => Some(Self::Csv),
            "npz" => Some(Self::Npz),
            "mcap" => Some(Self::Mcap),
            "glb" => Some(Self::Glb),
            _ => None,
        }
    }

    /// The format itself, for a file of that name: [`Self::Ros`] is one of its two forms.
    #[must_use]
    pub fn for_name(self, path: &Path) -> Self {
        match (self, Self::of_name(path)) {
            (Self::Ros, Some(Self::RosYaml)) => Self::RosYaml,
            (Self::Ros, _) => Self::RosJson,
            (other, _) => other,
        }
    }
}

/// What is exported, and how densely.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportOptions {
    /// Samples per second, of formats that sample.
    pub rate: f64,
    /// Only this robot's joints; all robots' without it.
    pub robot: Option<String>,
    /// Only these joints, `part/joint` or the bare name of a joint that only one robot has; all without it.
    pub joints: Option<Vec<String>>,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self { rate: 100.0, robot: None, joints: None }
    }
}

/// Most numbers of a file.
const NUMBERS: usize = 1 << 26;

/// Whether so many samples of so many numbers are written: a path of months has too many.
pub(super) fn fits(samples: usize, width: usize) -> Result<(), ExportError> {
    match samples.saturating_mul(width) > NUMBERS {
        true => {
            Err(ExportError::TooLarge("these are more than 2^26 numbers: lower the rate, or name a robot or joints"))
        }
        false => Ok(()),
    }
}

/// Why there is no export.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The path has no times, or no such joint or robot.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// A model cannot be read.
    #[error(transparent)]
    Model(#[from] SceneError),
    /// A format cannot hold what is asked.
    #[error("{0}")]
    TooLarge(&'static str),
    /// An archive or a recording cannot be written.
    #[error("{format} cannot be written: {source}")]
    Write {
        /// The format.
        format: &'static str,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl ExportError {
    pub(super) fn write(format: &'static str, source: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Write { format, source: Box::new(source) }
    }
}
