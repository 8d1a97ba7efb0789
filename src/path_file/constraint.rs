//! Constraints along a segment, as a path file says them.
//!
//! One table for all kinds; which keys a kind reads:
//!
//! | `kind` | keys | what holds |
//! |---|---|---|
//! | `pose` | `frame`, `to`, `mask`, `value`, `inequality` | the masked rows of value⁻¹ · (pose of `frame` in `to`) are zero |
//! | `centre_of_mass` | `parts`, `to`, `mask`, `value`, `inequality`, `planes` | the masked rows of the centre of mass in `to`, less `value`, are zero; every plane's row too |
//! | `centre_of_mass_between` | `parts`, `frame`, `to`, `height` | balance over the line between the origins of two frames |
//! | `distance` | `frame`, `to`, `length`, `bound` | the origins of the frames are `length` apart, or at least, or at most |
//! | `joint` | `joint`, `position` | the joint keeps its position |
//! | `custom` | – | a function of the program's own, which nobody else can prove |
//!
//! Rows are tx ty tz rx ry rz, in R³ × SO(3) and in the axes of the value: metres along the axes, radians of the rotation
//! vector. Where two rotations are masked their axes are held and the third is free: the error is the angle between the free
//! axis and where it should be. Rows of `inequality` (a subset of the mask) must not be negative; others are zero. Without a
//! `value` (`length`, `position`) the first knot of the segment is the reference. What is not zero is an error, and errors stay
//! within `tolerance` along the whole motion.

use super::PoseRow;
use foliate_components::Pose;
use foliate_components::constraint::{
    CentreOfMass, Constraint, Frame, Locked, LockedValue, Masses, PlaneRow, Reference, RelativePose, Row, Rows,
};
use foliate_components::path::PathConstraint;
use foliate_components::pose::pose_to_array;
use foliate_components::robot::Robot;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A constraint along a segment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ConstraintEntry {
    /// See the table above.
    pub kind: String,
    /// The problem's name for it; says nothing to a checker.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// The frame that is constrained (`centre_of_mass_between`: one foot).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<FrameEntry>,
    /// The frame in which it is read (`centre_of_mass_between`: the other foot).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<FrameEntry>,
    /// Rows that count: tx ty tz rx ry rz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mask: Option<[bool; 6]>,
    /// Those of them that must not be negative instead of zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inequality: Option<[bool; 6]>,
    /// The pose of `frame` in `to`; of a centre of mass only the position counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<PoseRow>,
    /// Parts whose common centre of mass is meant; without them the part of `frame`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<String>,
    /// Further rows on a centre of mass.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<PlaneEntry>,
    /// Height of the centre of mass over the middle of two feet, metres; free where it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<f64>,
    /// Distance, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<f64>,
    /// What is asked of a distance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound: Option<Bound>,
    /// `part/joint`, of one coordinate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// The joint's position, radians or metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// Bound of the error, metres and radians.
    pub tolerance: f64,
}

/// A frame: a name (`world`, a part for its root link, a gripper, a handle, `part/link`, `part/joint`), or a pose in one of these.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FrameEntry {
    /// The named frame itself.
    Named(String),
    /// A frame in it.
    Within {
        /// The name.
        link: String,
        /// Pose in the named frame.
        pose: PoseRow,
    },
}

impl FrameEntry {
    /// The name, and the pose in what it names.
    #[must_use]
    pub fn parts(&self) -> (&str, Option<&PoseRow>) {
        match self {
            Self::Named(name) => (name, None),
            Self::Within { link, pose } => (link, Some(pose)),
        }
    }
}

/// A plane that a centre of mass lies on, or on one side of: `normal · c − offset` is zero, or not negative.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlaneEntry {
    /// Unit normal, in `to`.
    pub normal: [f64; 3],
    /// Metres from the origin of `to`.
    pub offset: f64,
    /// Whether the side of the normal is allowed.
    #[serde(default)]
    pub inequality: bool,
}

/// What is asked of a distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// It is the length.
    #[default]
    Equal,
    /// It is no less.
    AtLeast,
    /// It is no more.
    AtMost,
}

/// The entries that say what a constraint demands: one, or two where translation rows and a turned reference have different
/// axes. Errors stay within `tolerance`, metres and radians.
pub(super) fn entries(robot: &Robot, demand: &PathConstraint, tolerance: f64) -> Vec<ConstraintEntry> {
    let argument = demand.argument.unwrap_or_default();
    let entry =
        |kind: &str| ConstraintEntry { kind: kind.into(), name: demand.name.clone(), tolerance, ..Default::default() };
    match &demand.constraint {
        Constraint::RelativePose(pose) => relative_pose(robot, pose, &argument, &entry("pose")),
        Constraint::Locked(locked) => vec![joint(robot, locked, &argument, entry("joint"))],
        Constraint::CentreOfMass(balance) => vec![centre_of_mass(robot, balance, &argument, entry("centre_of_mass"))],
        Constraint::CentreOfMassBetween(balance) => vec![ConstraintEntry {
            parts: parts(robot, &balance.masses),
            frame: Some(frame(robot, &balance.first)),
            to: Some(frame(robot, &balance.second)),
            height: balance.height,
            ..entry("centre_of_mass_between")
        }],
        Constraint::Distance(distance) => vec![ConstraintEntry {
            frame: Some(frame(robot, &distance.b)),
            to: Some(frame(robot, &distance.a)),
            length: Some(distance.length),
            bound: Some(match (distance.row, distance.at_most) {
                (Row::Inequality, false) => Bound::AtLeast,
                (Row::Inequality, true) => Bound::AtMost,
                (Row::Zero | Row::Parameter, _) => Bound::Equal,
            }),
            ..entry("distance")
        }],
        Constraint::Custom(_) => vec![entry("custom")],
        // Polygons that touch are attachments.
        Constraint::Placement(_) | Constraint::PlacementComplement(..) | Constraint::PlacementHold(..) => Vec::new(),
    }
}

/// A frame by a link that moves with it.
fn frame(robot: &Robot, frame: &Frame) -> FrameEntry {
    let Some(joint) = frame.joint else {
        return FrameEntry::Within { link: "world".into(), pose: pose_to_array(&frame.joint_from_frame) };
    };
    // The link that the joint moves comes first; others are fixed to it.
    let link = robot.links.iter().find(|link| link.joint == Some(joint));
    let Some(link) = link else {
        let (link, pose) = (robot.joints[joint.at()].name.clone(), pose_to_array(&frame.joint_from_frame));
        return FrameEntry::Within { link, pose };
    };
    let pose = link.joint_from_link.inverse() * frame.joint_from_frame;
    FrameEntry::Within { link: link.name.clone(), pose: pose_to_array(&pose) }
}

fn parts(robot: &Robot, masses: &Masses) -> Vec<String> {
    masses.parts().iter().map(|part| robot.parts[part.at()].name.clone()).collect()
}

fn referred(reference: Reference, argument: &Pose) -> Pose {
    match reference {
        Reference::Identity => Pose::identity(),
        Reference::Fixed(pose) => pose,
        Reference::Argument(_) => *argument,
    }
}

/// A file reads translations in the axes of the value, a constraint in those of frame A: where that makes a difference the
/// position is said with an unturned value, and the orientation on its own.
fn relative_pose(
    robot: &Robot,
    constraint: &RelativePose,
    argument: &Pose,
    entry: &ConstraintEntry,
) -> Vec<ConstraintEntry> {
    let reference = referred(constraint.reference, argument);
    let turned = reference.rotation.to_array() != [0.0, 0.0, 0.0, 1.0];
    let has = |rows: &[Option<Row>]| rows.iter().any(Option::is_some);
    let (shifts, turns) = constraint.rows.split_at(3);
    let with = |rows: Rows, value: Pose| ConstraintEntry {
        frame: Some(frame(robot, &constraint.b)),
        to: Some(frame(robot, &constraint.a)),
        mask: Some(rows.map(|row| row.is_some())),
        inequality: inequality(&rows),
        value: Some(pose_to_array(&value)),
        ..entry.clone()
    };
    if !(turned && has(shifts)) {
        return vec![with(constraint.rows, reference)];
    }
    let mut entries = vec![with(only(&constraint.rows, 0..3), Pose::from_translation(reference.translation))];
    if has(turns) {
        entries.push(with(only(&constraint.rows, 3..6), reference));
    }
    entries
}

fn only(rows: &Rows, kept: Range<usize>) -> Rows {
    std::array::from_fn(|i| rows[i].filter(|_| kept.contains(&i)))
}

fn inequality(rows: &Rows) -> Option<[bool; 6]> {
    rows.contains(&Some(Row::Inequality)).then(|| rows.map(|row| row == Some(Row::Inequality)))
}

fn joint(robot: &Robot, locked: &Locked, argument: &Pose, entry: ConstraintEntry) -> ConstraintEntry {
    let position = match locked.value {
        LockedValue::Fixed(value) => value,
        LockedValue::Argument(_) => argument.translation.x,
    };
    let joint = robot.joints[locked.joint.at()].name.clone();
    ConstraintEntry { joint: Some(joint), position: Some(position), ..entry }
}

/// Parameter rows are measured from the argument, others from the origin: said as offsets of planes.
fn centre_of_mass(robot: &Robot, balance: &CentreOfMass, argument: &Pose, entry: ConstraintEntry) -> ConstraintEntry {
    let from = referred(balance.reference, argument).translation;
    let plane = |plane: &PlaneRow| PlaneEntry {
        normal: plane.normal.to_array(),
        offset: plane.offset + if plane.row == Row::Parameter { plane.normal.dot(from) } else { 0.0 },
        inequality: plane.row == Row::Inequality,
    };
    ConstraintEntry {
        parts: parts(robot, &balance.masses),
        to: Some(frame(robot, &balance.frame)),
        planes: balance.rows.iter().map(plane).collect(),
        ..entry
    }
}
