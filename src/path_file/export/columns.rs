//! Which numbers are exported: joints of robots, those that follow others, and roots of robots; joints of objects, such as drawers.

use crate::path_file::export::options::ExportOptions;
use crate::planner::trajectory::curve::Derivatives;
use crate::planner::trajectory::error::TrajectoryError;
use crate::planner::trajectory::trajectory::{Moment, Trajectory};
use crate::scene::assemble::names::configuration::coordinate_names;
use foliate_components::robot::configuration::Group;
use foliate_components::robot::{PartIndex, PartKind, Source};

/// A number of a robot or an object.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// `part/joint`, or `part/x` and so on of a root.
    pub name: String,
    /// The robot or object.
    pub part: PartIndex,
    /// The coordinate that it is, or that it follows.
    pub coordinate: usize,
    /// Factor and offset of a joint that follows another one.
    pub follows: Option<(f64, f64)>,
    /// Whether it is a joint of one coordinate, and no part of a root.
    pub is_joint: bool,
}

impl Column {
    /// Its value and derivatives at a moment.
    pub fn at(&self, trajectory: &Trajectory<'_>, moment: &Moment<'_>) -> Derivatives {
        let [value, rate, acceleration] = coordinate(trajectory, moment, self.coordinate);
        match self.follows {
            None => [value, rate, acceleration],
            Some((multiplier, offset)) => [multiplier * value + offset, multiplier * rate, multiplier * acceleration],
        }
    }

    /// The name without its part.
    pub fn bare(&self) -> &str {
        self.name.split_once('/').map_or(&self.name, |(_, bare)| bare)
    }
}

/// A coordinate at a moment, as the path writes it: objects with a carrier are elsewhere.
fn coordinate(trajectory: &Trajectory<'_>, moment: &Moment<'_>, index: usize) -> Derivatives {
    let mut flyers = trajectory.robot().space.factors.iter().filter(|factor| factor.group == Group::FreeFlyer);
    match flyers.find(|flyer| (flyer.q + 3..flyer.q + 7).contains(&index)) {
        Some(flyer) => moment.piece.quaternion(flyer.q + 3)[index - flyer.q - 3],
        None => moment.piece.number(index),
    }
}

/// The numbers that are asked for, those of robots first, or in the order of the names that are given.
pub(super) fn columns(trajectory: &Trajectory<'_>, options: &ExportOptions) -> Result<Vec<Column>, TrajectoryError> {
    if let Some(robot) = &options.robot {
        // Says which robots there are.
        trajectory.joint_names(robot)?;
    }
    let all: Vec<Column> = of_kind(trajectory, PartKind::Robot)
        .into_iter()
        .chain(of_kind(trajectory, PartKind::Object))
        .filter(|column| {
            let name = &trajectory.robot().parts[column.part.at()].name;
            options.robot.as_ref().is_none_or(|robot| robot == name)
        })
        .collect();
    let Some(names) = &options.joints else { return Ok(all) };
    let find = |name: &String| {
        let found = |full: bool| all.iter().filter(move |c| if full { c.name == *name } else { c.bare() == name });
        let mut meant = found(true).chain(found(false).filter(|_| found(true).next().is_none()));
        match (meant.next(), meant.next()) {
            (Some(column), None) => Ok(column.clone()),
            (Some(one), Some(other)) => {
                let hint = format!("several parts have it: {}, {}", one.name, other.name);
                Err(TrajectoryError::Unknown { what: "one joint", name: name.clone(), hint })
            }
            (None, _) => Err(TrajectoryError::unknown("joint", name, all.iter().map(|c| c.name.as_str()))),
        }
    };
    names.iter().map(find).collect()
}

/// The numbers of all robots, or the joints of all objects without their roots.
fn of_kind(trajectory: &Trajectory<'_>, kind: PartKind) -> Vec<Column> {
    let robot = trajectory.robot();
    let names = coordinate_names(robot);
    let mut columns = Vec::new();
    for (index, joint) in robot.joints.iter().enumerate() {
        let part = &robot.parts[joint.part.at()];
        let is_objects_root = kind == PartKind::Object && part.root_joint.is_some_and(|root| root.at() == index);
        if part.kind != kind || is_objects_root {
            continue;
        }
        let size = joint.motion.configuration_size();
        match joint.source {
            Source::Coordinates { q, .. } => columns.extend((q..q + size).map(|coordinate| {
                let name = names[coordinate].clone();
                Column { name, part: joint.part, coordinate, follows: None, is_joint: size == 1 }
            })),
            Source::Follows { leader, multiplier, offset } => {
                let Source::Coordinates { q, .. } = robot.joints[leader.at()].source else { continue };
                let (name, follows) = (joint.name.clone(), Some((multiplier, offset)));
                columns.push(Column { name, part: joint.part, coordinate: q, follows, is_joint: true });
            }
        }
    }
    columns
}
