//! `foliate export`: a path file for other programs.

use crate::cli::console::loading;
use crate::cli::console::loading::{Cut, Failure};
use crate::cli::console::outputs;
use crate::cli::console::print::{Ending, Refusal, print, say};
use crate::export::{ExportError, ExportOptions, Exported, Format, export};
use crate::output;
use crate::path_file::{LoadPathError, LoadedPath};
use crate::scene::PackagePath;
use crate::trajectory::TrajectoryError;
use std::path::PathBuf;
use std::time::Duration;

/// Writes a path for other programs: ROS, tables, NumPy, Foxglove, glTF
#[derive(clap::Args, Clone)]
pub(crate) struct Arguments {
    /// The path file
    #[arg(value_name = "PATH.json")]
    path: PathBuf,
    /// The format; without it the ending of the file's name decides
    #[arg(long, value_enum, value_name = "FORMAT")]
    to: Option<Format>,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// Samples per second, of formats that sample (all but ros, which has the path's own knots)
    #[arg(long, default_value_t = ExportOptions::default().rate, value_name = "HZ")]
    rate: f64,
    /// Only this robot's joints, instead of all robots'
    #[arg(long, value_name = "NAME")]
    robot: Option<String>,
    /// Only these joints, in this order: `part/joint`, or the bare name of a joint that only one robot has
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    joints: Option<Vec<String>>,
    /// Seconds after which to give up
    #[arg(long, default_value_t = 600.0, value_name = "S")]
    time_limit: f64,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let format = match (arguments.to, Format::of_name(&arguments.out)) {
        (Some(format), _) => format.for_name(&arguments.out),
        (None, Some(format)) => format,
        (None, None) => {
            let name = arguments.out.display();
            return Err(Refusal(format!("{name}: no format is called so; name one with --to")));
        }
    };
    outputs::check(arguments.path.to_str(), [&arguments.out])?;
    let limit = crate::cli::commands::solve::arguments::deadline(arguments.time_limit)?;
    let (mine, packages) = (arguments.clone(), packages.clone());
    let worked = loading::beside(limit, Duration::ZERO, move |stop| {
        let packages = loading::until(&packages, stop);
        written(&mine, format, &packages)
    })?;
    let exported = match worked {
        Ok(exported) => exported,
        Err(Cut::Interrupted) => return Ok(Ending::Interrupted),
        Err(Cut::OutOfTime) => return Err(Refusal("the time limit was reached; nothing is written".into())),
    };
    for warning in &exported.warnings {
        say(&format!("warning: {warning}\n"));
    }
    let place = arguments.out.display();
    output::write(&arguments.out, &exported.bytes).map_err(|e| Refusal(format!("{place}: {e}")))?;
    if output::is_file(&arguments.out) {
        print(&format!("{place}: {} bytes\n", exported.bytes.len()));
    }
    Ok(Ending::Done)
}

fn written(arguments: &Arguments, format: Format, packages: &PackagePath) -> Result<Exported, Failure> {
    let place = arguments.path.display();
    let path = LoadedPath::read(&arguments.path, packages).map_err(|error| match error {
        LoadPathError::Model { error, .. } if error.stopped.is_some() => Failure::from(*error),
        LoadPathError::File(error) => Refusal(error.to_string()).into(),
        other => Refusal(format!("{place}: {other}")).into(),
    })?;
    let (rate, robot, joints) = (arguments.rate, arguments.robot.clone(), arguments.joints.clone());
    export(&path, format, &ExportOptions { rate, robot, joints }, packages).map_err(|error| match error {
        ExportError::Model(error) => Failure::from(error),
        ExportError::Trajectory(TrajectoryError::NoTimes) => {
            let hint = "`solve` without --first gives it times; --to csv writes its knots as they are";
            Refusal(format!("{place}: the path has no times ({hint})")).into()
        }
        other => Refusal(format!("{place}: {other}")).into(),
    })
}
