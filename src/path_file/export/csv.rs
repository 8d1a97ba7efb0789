//! Tables: a row for each sample, a column for each coordinate.

use crate::path_file::export::columns::columns;
use crate::path_file::export::options::{ExportError, ExportOptions, fits};
use crate::planner::trajectory::trajectory::Trajectory;
use crate::scene::assemble::names::configuration::coordinate_names;
use foliate_components::path::ManipulationPath;
use foliate_components::robot::{PartKind, Robot};
use std::fmt::Write;

/// A trajectory as a table: `time` and the coordinates of robots and objects (radians, metres), objects where they are.
///
/// With `robot` or `joints` in the options it has only these numbers of robots.
///
/// # Errors
/// There is no such robot or joint; the rate is none; there are more than 2²⁶ numbers.
pub fn csv(trajectory: &Trajectory<'_>, options: &ExportOptions) -> Result<String, ExportError> {
    let (names, picked) = picked(trajectory, options)?;
    let mut out = header(Some("time"), &names);
    let mut poses = trajectory.poses();
    let times = trajectory.sample_times(options.rate)?;
    fits(times.len(), picked.len() + 1)?;
    for time in times {
        poses.place(time);
        let q = poses.configuration();
        row(&mut out, Some(time), picked.iter().map(|&(index, factor, offset)| factor * q[index] + offset));
    }
    Ok(out)
}

/// Column names, and for each a coordinate with its factor and offset.
#[allow(clippy::type_complexity, reason = "two lists of one length")]
fn picked(
    trajectory: &Trajectory<'_>,
    options: &ExportOptions,
) -> Result<(Vec<String>, Vec<(usize, f64, f64)>), ExportError> {
    if options.robot.is_none() && options.joints.is_none() {
        let (names, indices) = moving(trajectory.robot());
        return Ok((names, indices.into_iter().map(|index| (index, 1.0, 0.0)).collect()));
    }
    let columns = columns(trajectory, options)?;
    let number = |column: &super::columns::Column| {
        let (factor, offset) = column.follows.unwrap_or((1.0, 0.0));
        (column.coordinate, factor, offset)
    };
    Ok((columns.iter().map(|column| column.name.clone()).collect(), columns.iter().map(number).collect()))
}

/// A path without times as a table of its knots; the joint knot of two segments is there once.
#[must_use]
pub fn csv_of_knots(robot: &Robot, path: &ManipulationPath) -> String {
    let (names, indices) = moving(robot);
    let mut out = header(None, &names);
    let mut last: Option<&Vec<f64>> = None;
    for knot in path.segments.iter().flat_map(|segment| &segment.knots) {
        if last != Some(knot) {
            row(&mut out, None, indices.iter().map(|&index| knot[index]));
        }
        last = Some(knot);
    }
    out
}

/// The coordinates of all but environments.
fn moving(robot: &Robot) -> (Vec<String>, Vec<usize>) {
    let is_still = |name: &str| {
        let part = name.split('/').next().and_then(|part| robot.part(part));
        part.is_some_and(|part| robot.parts[part.at()].kind == PartKind::Environment)
    };
    let names = coordinate_names(robot).into_iter().enumerate();
    names.filter(|(_, name)| !is_still(name)).map(|(index, name)| (name, index)).unzip()
}

fn header(time: Option<&str>, names: &[String]) -> String {
    let names = time.into_iter().chain(names.iter().map(String::as_str));
    names.collect::<Vec<_>>().join(",") + "\n"
}

fn row(out: &mut String, time: Option<f64>, numbers: impl Iterator<Item = f64>) {
    for (index, number) in time.into_iter().chain(numbers).enumerate() {
        let comma = if index > 0 { "," } else { "" };
        let _ = write!(out, "{comma}{number:?}");
    }
    out.push('\n');
}
