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
//! | `tilt` | `frame`, `to`, `within` | the angle between the z axes of the frames is at most `within` |
//! | `region` | `frame`, `to`, `planes` | the origin of `frame`, read in `to`, keeps every plane's row |
//! | `joint` | `joint`, `position` | the joint keeps its position |
//! | `custom` | – | a function of the program that planned, which no other program can prove |
//!
//! Rows are tx ty tz rx ry rz, in R³ × SO(3) and in the axes of the value: metres along the axes, radians of the rotation
//! vector. Where two rotations are masked their axes are held and the third is free: the error is the angle between the free
//! axis and where it should be. Rows of `inequality` (a subset of the mask) must not be negative; others are zero. Without a
//! `value` (`length`, `position`) the first knot of the segment is the reference. What is not zero is an error, and errors stay
//! within `tolerance` along the whole motion.

use foliate_components::Pose;
use foliate_components::constraint::{
    CentreOfMass, Constraint, Frame, Locked, LockedValue, Masses, PlaneRow, Reference, RelativePose, Row, Rows,
};
use foliate_components::path::PathConstraint;
use foliate_components::pose::pose_to_array;
use foliate_components::robot::Robot;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A constraint along a segment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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
    /// Further rows on a centre of mass; those of a region.
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
    /// The largest angle between two axes, radians.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<f64>,
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
#[serde(untagged, deny_unknown_fields)]
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

/// A plane that a centre of mass or a point lies on, or on one side of: `normal · c − offset` is zero, or not negative.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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

/// The entries that express a constraint: one, or two where translation rows and a turned reference have different
/// axes. Errors stay within `tolerance`, metres and radians.
pub(crate) fn entries(robot: &Robot, requirement: &PathConstraint, tolerance: f64) -> Vec<ConstraintEntry> {
    let argument = requirement.argument.unwrap_or_default();
    let entry = |kind: &str| ConstraintEntry {
        kind: kind.into(),
        name: requirement.name.clone(),
        tolerance,
        ..Default::default()
    };
    match &requirement.constraint {
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
        Constraint::Tilt(tilt) => vec![ConstraintEntry {
            frame: Some(frame(robot, &tilt.b)),
            to: Some(frame(robot, &tilt.a)),
            within: Some(tilt.within),
            ..entry("tilt")
        }],
        Constraint::Region(region) => vec![ConstraintEntry {
            frame: Some(frame(robot, &region.b)),
            to: Some(frame(robot, &region.a)),
            planes: region.rows().iter().map(|row| plane_entry(row, DVec3::ZERO)).collect(),
            ..entry("region")
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
    ConstraintEntry {
        parts: parts(robot, &balance.masses),
        to: Some(frame(robot, &balance.frame)),
        planes: balance.rows.iter().map(|plane| plane_entry(plane, from)).collect(),
        ..entry
    }
}

fn plane_entry(plane: &PlaneRow, from: DVec3) -> PlaneEntry {
    PlaneEntry {
        normal: plane.normal.to_array(),
        offset: plane.offset + if plane.row == Row::Parameter { plane.normal.dot(from) } else { 0.0 },
        inequality: plane.row == Row::Inequality,
    }
}

/// x y z qx qy qz qw.
pub type PoseRow = [f64; 7];

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::Pose;
    use foliate_components::constraint::{Constraint, Frame, Mask, Reference, RelativePose};
    use foliate_components::path::PathConstraint;
    use foliate_components::pose::{exp_so3, log_so3, pose_from_array, pose_to_array};
    use foliate_components::robot::{JointIndex, Robot};
    use foliate_components::samples::boxes_on_a_table;
    use foliate_kernels::constraints::{placement_of, relative_pose};
    use foliate_kernels::kinematics::Kinematics;

    /// Numbers in [-1, 1), the same in every run.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.next(), self.next(), self.next())
        }

        fn pose(&mut self) -> Pose {
            Pose::from_parts(self.vector(), exp_so3(self.vector()))
        }
    }

    /// Where a written frame is.
    fn placed(robot: &Robot, frame: &FrameEntry, bodies: &[Pose]) -> Pose {
        let (name, within) = frame.parts();
        let link = robot.link(name).map(|l| &robot.links[l.at()]);
        let body = link.and_then(|l| l.joint).map_or(Pose::identity(), |j| bodies[j.at()]);
        let fixed = link.map_or(Pose::identity(), |l| l.joint_from_link);
        body * fixed * within.and_then(|w| pose_from_array(*w)).unwrap_or_default()
    }

    /// The rows of an entry as the table says them.
    fn read(robot: &Robot, entry: &ConstraintEntry, bodies: &[Pose]) -> [Option<f64>; 6] {
        let place = |frame: &Option<FrameEntry>| placed(robot, frame.as_ref().unwrap(), bodies);
        let value = pose_from_array(entry.value.unwrap()).unwrap();
        let off = value.inverse() * (place(&entry.to).inverse() * place(&entry.frame));
        let turn = log_so3(off.rotation);
        let rows = [off.translation.to_array(), turn.to_array()].concat();
        let mask = entry.mask.unwrap();
        std::array::from_fn(|i| mask[i].then_some(rows[i]))
    }

    #[test]
    fn a_written_pose_has_the_rows_of_its_constraint() {
        let robot = boxes_on_a_table(&[(0.6, 0.2)], &[(0.7, 0.1)]).unwrap().robot;
        let kinematics = Kinematics::new(&robot);
        let mut random = Numbers(3);
        let mut bodies = vec![Pose::identity(); kinematics.bodies()];
        for case in 0..300 {
            let q: Vec<f64> = (0..robot.space.size() - 7).map(|_| 2.0 * random.next()).collect();
            let q: Vec<f64> = q.into_iter().chain(pose_to_array(&random.pose())).collect();
            kinematics.forward(&q, &mut bodies);
            let mut frame = || {
                let joint = ((random.next() + 1.0) / 2.0 * (robot.joints.len() + 1) as f64) as usize;
                let joint = (joint < robot.joints.len()).then_some(JointIndex(joint as u32));
                Frame { joint, joint_from_frame: random.pose() }
            };
            let (a, b) = (frame(), frame());
            let turns = case % 2 == 0;
            let zero = Mask(std::array::from_fn(|i| if i < 3 { random.next() > 0.2 } else { turns }));
            let free = Mask(std::array::from_fn(|i| i < 3 && random.next() > 0.0));
            let argument = random.pose();
            let reference = match case % 3 {
                0 => Reference::Identity,
                1 => Reference::Fixed(random.pose()),
                _ => Reference::Argument(0),
            };
            let rows = foliate_components::constraint::rows(zero, free);
            let constraint = RelativePose { a, b, rows, reference };
            let wanted =
                relative_pose::value(&placement_of(&a), &placement_of(&b), &referred(reference, &argument), &bodies);
            let requirement = PathConstraint {
                name: "given".into(),
                constraint: Constraint::RelativePose(constraint),
                argument: Some(argument),
            };
            let mut found = [None; 6];
            for entry in entries(&robot, &requirement, 1e-4) {
                for (all, row) in found.iter_mut().zip(read(&robot, &entry, &bodies)) {
                    assert!(all.is_none() || row.is_none(), "a row is said twice");
                    *all = all.or(row);
                }
            }
            for i in 0..6 {
                assert_eq!(found[i].is_some(), rows[i].is_some());
                assert!(found[i].is_none_or(|value| (value - wanted[i]).abs() < 1e-9), "{found:?} {wanted:?}");
            }
        }
    }
}
