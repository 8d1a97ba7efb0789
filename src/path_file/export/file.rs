//! One format of one path file.

use crate::path_file::export::csv::{csv, csv_of_knots};
use crate::path_file::export::gltf::scene::glb;
use crate::path_file::export::mcap::mcap;
use crate::path_file::export::npz::npz;
use crate::path_file::export::options::{ExportError, ExportOptions, Format};
use crate::path_file::export::ros::{ros_json, ros_yaml};
use crate::path_file::loaded_path::LoadedPath;
use crate::planner::trajectory::error::TrajectoryError;
use crate::scene::reading::error::SceneError;
use crate::scene::sources::package::PackagePath;
use crate::scene::visuals::Visuals;

/// What is to be written.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The file.
    pub bytes: Vec<u8>,
    /// Remarks about models that it shows.
    pub warnings: Vec<SceneError>,
}

/// Writes a path for another program. Only [`Format::Csv`] needs no times: without them it has the path's knots.
///
/// # Errors
/// The path has no times; there is no such robot or joint; a model cannot be read.
pub fn export(
    path: &LoadedPath,
    format: Format,
    options: &ExportOptions,
    packages: &PackagePath,
) -> Result<Exported, ExportError> {
    let of = |bytes: Vec<u8>| Exported { bytes, warnings: Vec::new() };
    let trajectory = match path.trajectory() {
        Err(TrajectoryError::NoTimes) if format == Format::Csv && *options == ExportOptions::default() => {
            return Ok(of(csv_of_knots(&path.robot, &path.path).into_bytes()));
        }
        trajectory => trajectory?,
    };
    Ok(match format {
        Format::Ros | Format::RosJson => of(ros_json(&trajectory, options)?.into_bytes()),
        Format::RosYaml => of(ros_yaml(&trajectory, options)?.into_bytes()),
        Format::Csv => of(csv(&trajectory, options)?.into_bytes()),
        Format::Npz => of(npz(&trajectory, options)?),
        Format::Mcap => of(mcap(&trajectory, options)?),
        Format::Glb => {
            let visuals = Visuals::read(path, packages)?;
            Exported { bytes: glb(&trajectory, &visuals, options)?, warnings: visuals.warnings }
        }
    })
}
