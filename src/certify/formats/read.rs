//! What all formats have in common: which format a file has, which joints its names mean, and an error that says where.

use crate::certify::formats::table::{CAP, COLUMNS, Table};
use crate::certify::formats::{csv, numpy, ompl, own, ros};
use crate::certify::motion::how::{How, Interpolation, Turns};
use crate::certify::motion::names::{JointNames, Meaning};
use crate::certify::motion::piecewise::{Motion, Point};
use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::input;
use foliate_components::robot::Robot;
use std::path::Path;
/// What followers may be off their leaders, radians or metres.
const FOLLOWS: f64 = 1e-6;

/// How a motion is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Format {
    /// Values between commas, semicolons or tabs; the first line names the columns
    Csv,
    /// JSON of `trajectory_msgs/JointTrajectory`, or of MoveIt's `RobotTrajectory` or `DisplayTrajectory`
    Ros,
    /// A path matrix of OMPL: numbers between blanks, one state a line
    Ompl,
    /// A NumPy array, one row a state
    Npy,
    /// NumPy arrays `positions`, and where there are any `times`, `velocities`, `accelerations`, `names`
    Npz,
    /// A path file of our own
    Foliate,
}

/// How to read a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// The format; found from the file where none is given.
    pub format: Option<Format>,
    /// Names of the columns, where the file has none.
    pub joints: Option<Vec<String>>,
    /// How to go from point to point.
    pub interpolation: Interpolation,
    /// Which way joints without limits go.
    pub turns: Turns,
}

/// Reads a motion of a robot from a file.
///
/// # Errors
/// No regular file, or larger than 256 MiB; not of its format; a number that is not finite; a joint that the scene does not have;
/// whatever [`Motion::through`] refuses. The error names file, line or element, and the way out.
pub fn read(path: &Path, robot: &Robot, options: &ReadOptions) -> Result<Motion, SceneError> {
    let content = input::bytes(path, CAP)?;
    let file = path.display().to_string();
    read_bytes(&file, content, robot, options)
}

/// As [`read`], from what is in the file; `file` is what errors call it.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(file: &str, content: Vec<u8>, robot: &Robot, options: &ReadOptions) -> Result<Motion, SceneError> {
    let format = match options.format {
        Some(format) => format,
        None => detect(file, &content)?,
    };
    let table = match format {
        Format::Npy => numpy::npy(file, &content)?,
        Format::Npz => numpy::npz(file, content)?,
        Format::Csv => csv::read(file, &input::decode(content, file)?)?,
        Format::Ompl => ompl::read(file, &input::decode(content, file)?)?,
        Format::Ros => ros::read(file, &input::decode(content, file)?, robot)?,
        Format::Foliate => own::read(file, &input::decode(content, file)?)?,
    };
    Reader { file, robot, options }.motion(table)
}

/// The format of a file, from its first bytes.
fn detect(file: &str, content: &[u8]) -> Result<Format, SceneError> {
    if content.starts_with(b"\x93NUMPY") {
        return Ok(Format::Npy);
    }
    if content.starts_with(b"PK\x03\x04") || content.starts_with(b"PK\x05\x06") {
        return Ok(Format::Npz);
    }
    let text = content.strip_prefix(b"\xef\xbb\xbf").unwrap_or(content).trim_ascii_start();
    let head = String::from_utf8_lossy(&text[..text.len().min(1 << 16)]).into_owned();
    if head.starts_with('{') {
        // The key comes first in our own files; the value is no name of a joint.
        return Ok(if head.contains("\"foliate.path/") { Format::Foliate } else { Format::Ros });
    }
    let line = head.lines().next().unwrap_or_default();
    let numbers = line.split_whitespace().all(|word| word.parse::<f64>().is_ok());
    match (line.is_empty(), numbers) {
        (true, _) => Err(SceneError::new(file, "file", "is empty")),
        (false, true) => Ok(Format::Ompl),
        (false, false) if head.chars().all(|c| !c.is_control() || c.is_whitespace()) => Ok(Format::Csv),
        _ => Err(SceneError::new(file, "file", "is of no format that is known").hint("name it with --format")),
    }
}

/// Makes a motion of a table.
struct Reader<'a> {
    file: &'a str,
    robot: &'a Robot,
    options: &'a ReadOptions,
}

impl Reader<'_> {
    fn motion(&self, mut table: Table) -> Result<Motion, SceneError> {
        let names = JointNames::new(self.robot);
        let joints = self.joints(&mut table)?;
        let (coordinates, kept) = self.columns(&names, &joints, &table)?;
        let everything = kept.len() == joints.len() && kept.iter().enumerate().all(|(i, &k)| i == k);
        if !everything {
            for point in &mut table.points {
                let pick = |row: &mut Vec<f64>| *row = kept.iter().map(|&k| row[k]).collect();
                let derivatives = point.velocities.iter_mut().chain(&mut point.accelerations);
                std::iter::once(&mut point.positions).chain(derivatives).for_each(pick);
            }
        }
        let straight: Vec<usize> = (0..kept.len()).filter(|&i| table.straight.contains(&kept[i])).collect();
        let turns = match self.options.turns {
            Turns::Format if table.shortest => Turns::Shortest,
            other => other,
        };
        let how = How { interpolation: self.options.interpolation, turns, straight: &straight, scaled: table.scaled };
        let motion = Motion::through_some(self.robot, coordinates, &table.points, &how);
        let mut motion = motion.map_err(|e| self.at(&table, e.point, e.message).hint(e.hint))?;
        motion.start = self.start(&names, &motion, &table);
        motion.attachments = table.attachments;
        motion.notes = table.notes;
        Ok(motion)
    }

    /// An error about a point.
    fn at(&self, table: &Table, point: usize, message: impl Into<String>) -> SceneError {
        let element = format!("{}[{point}]", if table.element.is_empty() { "points" } else { table.element });
        SceneError::new(self.file, element, message).at(table.lines.get(point).copied())
    }

    /// Names of the columns, and whether every row has as many.
    fn joints(&self, table: &mut Table) -> Result<Vec<String>, SceneError> {
        let width = table.points.first().map_or(0, |p| p.positions.len());
        let joints = match (table.joints.take(), &self.options.joints) {
            (Some(_), Some(_)) => {
                let message = "names its joints itself";
                return Err(SceneError::new(self.file, "--joints", message).hint("leave --joints out"));
            }
            (Some(own), None) => own,
            (None, Some(given)) => given.clone(),
            (None, None) => {
                let message = format!("has {width} columns and no names for them");
                return Err(SceneError::new(self.file, "file", message).hint("name them: --joints a,b,c"));
            }
        };
        if joints.len() > COLUMNS {
            let message = format!("{} joints are named, at most {COLUMNS} are read", joints.len());
            return Err(SceneError::new(self.file, "file", message));
        }
        for (index, point) in table.points.iter().enumerate() {
            let rows = [Some(&point.positions), point.velocities.as_ref(), point.accelerations.as_ref()];
            if let Some(row) = rows.into_iter().flatten().find(|row| row.len() != joints.len()) {
                let message = format!("has {} numbers, and {} joints are named", row.len(), joints.len());
                return Err(self.at(table, index, message).hint(joints.join(",")));
            }
        }
        Ok(joints)
    }

    /// Coordinates of the columns that have any, and which columns these are: followers are left out where they follow.
    fn columns(
        &self,
        names: &JointNames,
        joints: &[String],
        table: &Table,
    ) -> Result<(Vec<usize>, Vec<usize>), SceneError> {
        let (mut coordinates, mut kept, mut followers) = (Vec::new(), Vec::new(), Vec::new());
        for (column, name) in joints.iter().enumerate() {
            let found = names
                .find(name)
                .map_err(|(message, hint)| SceneError::new(self.file, format!("joint {column}"), message).hint(hint))?;
            match found {
                Meaning::Coordinate(i) if coordinates.contains(&i) => {
                    let message = format!("`{}` is named a second time", quoted(name));
                    return Err(SceneError::new(self.file, format!("joint {column}"), message));
                }
                Meaning::Coordinate(i) => {
                    coordinates.push(i);
                    kept.push(column);
                }
                Meaning::Follower { coordinate, multiplier, offset } => {
                    followers.push((column, coordinate, multiplier, offset));
                }
            }
        }
        for (column, coordinate, multiplier, offset) in followers {
            let leader = coordinates.iter().position(|&c| c == coordinate).map(|i| kept[i]);
            let wrong = |point: &Point| {
                let leader = leader.map(|l| point.positions[l]);
                let off = leader.map(|l| (multiplier * l + offset - point.positions[column]).abs());
                !off.is_some_and(|off| off <= FOLLOWS)
            };
            if let Some(point) = table.points.iter().position(wrong) {
                let (name, leader) = (quoted(&joints[column]), &names.coordinates()[coordinate]);
                let message = format!("`{name}` mimics `{leader}` and is not {multiplier} times it plus {offset}");
                return Err(self.at(table, point, message).hint("leave it out: it follows"));
            }
        }
        Ok((coordinates, kept))
    }

    /// What the file says of joints that it does not move, where the scene has them.
    fn start(&self, names: &JointNames, motion: &Motion, table: &Table) -> Vec<(usize, f64)> {
        let coordinate = |(name, value): &(String, f64)| match names.find(name) {
            Ok(Meaning::Coordinate(i)) if !motion.coordinates.contains(&i) && value.is_finite() => Some((i, *value)),
            _ => None,
        };
        table.start.iter().filter_map(coordinate).collect()
    }
}
