//! What the scene requires of a segment is in the file and holds: constraints that hold everywhere or in a state of the
//! problem's own, planes that objects stand on, joints that rest.
//!
//! Requirements are expressed as entries of path files, so that the file's own constraints can be recognised: these are proved
//! anyway. What cannot be recognised (parameters of a centre of mass, which are free from leaf to leaf) is proved here.

use super::parts::same_pose;
use crate::check::contract::scene_contract::Contract;
use crate::check::leaf::articulation::held_beyond;
use crate::check::leaf::on_leaf::Leaf;
use crate::check::leaf::{balance, constraint};
use crate::check::motion::reach::Reach;
use crate::check::motion::segment::SegmentMotion;
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::check::report::work::Work;
use crate::check::world::documents::Frames;
use crate::path_file::constraint::entries as constraint_entries;
use crate::path_file::document::PathFile;
use crate::path_file::{ConstraintEntry, FrameEntry};
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Locked, LockedValue, Reference, RelativePose, Row};
use foliate_components::path::PathConstraint;
use foliate_components::pose::{log_so3, pose_from_array};
use foliate_components::problem::{JointRest, NamedConstraint};
use foliate_components::robot::Robot;
use glam::DVec3;

/// Rounding of numbers that are read from the same ones.
const SAME: f64 = 1e-9;
/// How far the zero rows of a leaf's value may be from zero, metres and radians: the accuracy of projections.
const NEAR: f64 = 1e-6;
/// A motion is within the path tolerance of its leaf, and so is its first knot.
const FROM_THE_FIRST_KNOT: f64 = 2.1;

/// How a file's constraints express what a scene requires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Said {
    /// As it is: then the file's own are proved, and with them the requirement.
    Exactly,
    /// About the same frames and rows; the requirement is proved on its own.
    Loosely,
    No,
}

impl Contract<'_> {
    pub(in crate::check) fn required_constraints(
        &self,
        file: &PathFile,
        motion: &SegmentMotion<'_>,
        frames: &Frames,
        report: &mut CheckReport,
        work: &mut Work,
    ) -> Result<(), CheckError> {
        let options = &self.problem.graph;
        let mut required: Vec<NamedConstraint> =
            options.everywhere.iter().map(|&number| options.constraints[number as usize].clone()).collect();
        required.extend(self.of_held(motion));
        required.extend(self.on_lines(file, motion.index));
        self.line_ends(file, motion, frames, report)?;
        self.lifts(file, motion, frames, report, work)?;
        required.extend(self.resting_joints(motion));
        required.extend(self.planes(motion));
        if !options.states.is_empty() {
            match self.state_of(file, motion.index) {
                Some(state) => {
                    let numbers = &options.states[state].constraints;
                    required.extend(numbers.iter().map(|&number| options.constraints[number as usize].clone()));
                }
                None => {
                    let place = Place { segment: Some(motion.index), t: None };
                    let subject = "the segment's constraints are those of no state that may follow here";
                    report.violate(place, Kind::Demand, subject, None, None);
                }
            }
        }
        for named in &required {
            self.require(named, file, motion, frames, report, work)?;
        }
        Ok(())
    }

    fn require(
        &self,
        named: &NamedConstraint,
        file: &PathFile,
        motion: &SegmentMotion<'_>,
        frames: &Frames,
        report: &mut CheckReport,
        work: &mut Work,
    ) -> Result<(), CheckError> {
        match said(&self.problem.robot, named, file, motion.index) {
            Said::Exactly => return Ok(()),
            Said::Loosely => {}
            Said::No => {
                let place = Place { segment: Some(motion.index), t: None };
                let subject = format!("`{}` of the scene is not among the segment's constraints", named.name);
                report.violate(place, Kind::Demand, subject, None, None);
            }
        }
        let mut scratch = CheckReport::default();
        hold(&self.problem.robot, named, motion, file, frames, &mut scratch, work)?;
        for broken in scratch.violations {
            let place = Place { segment: broken.segment, t: broken.t };
            let subject = format!("`{}` of the scene: {}", named.name, broken.subject);
            report.violate(place, Kind::Demand, subject, broken.value, broken.limit);
        }
        Ok(())
    }

    /// Constraints that hold while a gripper holds an object, where one does.
    fn of_held(&self, motion: &SegmentMotion<'_>) -> Vec<NamedConstraint> {
        let (robot, options) = (&self.problem.robot, &self.problem.graph);
        let rules = options.while_held.iter().filter(|rule| is_held(motion, &robot.parts[rule.object.at()].name));
        rules.flat_map(|rule| &rule.constraints).map(|&number| options.constraints[number as usize].clone()).collect()
    }

    /// Resting joints, while no gripper holds what is beyond them.
    fn resting_joints(&self, motion: &SegmentMotion<'_>) -> Vec<NamedConstraint> {
        let robot = &self.problem.robot;
        let requirement = |resting: &foliate_components::problem::RestingJoint| {
            let name = &robot.joints[resting.joint.at()].name;
            let body = motion.world.bodies.iter().position(|body| body.name == *name)?;
            let value = match resting.rest {
                JointRest::At(value) => LockedValue::Fixed(value),
                JointRest::Stays => LockedValue::Argument(0),
            };
            let locked = Locked { joint: resting.joint, value };
            let named = NamedConstraint { name: format!("{name} rests"), constraint: Constraint::Locked(locked) };
            (!held_beyond(motion, body)).then_some(named)
        };
        self.problem.graph.resting_joints.iter().filter_map(requirement).collect()
    }

    /// Objects that no gripper holds stand on their planes.
    fn planes(&self, motion: &SegmentMotion<'_>) -> Vec<NamedConstraint> {
        let robot = &self.problem.robot;
        let requirement = |object: &foliate_components::problem::ObjectOptions| {
            let plane = object.plane.as_ref()?;
            let part = &robot.parts[object.part.at()];
            let held = is_held(motion, &part.name);
            let zero = Some(Row::Zero);
            let stands = RelativePose {
                a: Frame::world(plane.world_from_plane),
                b: Frame::on_link(robot, part.root_link, &plane.object_from_frame),
                rows: [None, None, zero, zero, zero, None],
                reference: Reference::Identity,
            };
            let name = format!("{} stands on its plane", part.name);
            (!held).then_some(NamedConstraint { name, constraint: Constraint::RelativePose(stands) })
        };
        self.problem.graph.objects.iter().filter_map(requirement).collect()
    }
}

/// Whether a gripper holds a part.
pub(super) fn is_held(motion: &SegmentMotion<'_>, part: &str) -> bool {
    motion.attachments.iter().any(|a| motion.world.parts[a.part].name == part && a.is_grasp())
}

/// Whether a constraint holds along a motion.
pub(super) fn all_hold(
    robot: &Robot,
    named: &NamedConstraint,
    motion: &SegmentMotion<'_>,
    file: &PathFile,
    frames: &Frames,
    work: &mut Work,
) -> Result<bool, CheckError> {
    let mut scratch = CheckReport::default();
    // Parameters require nothing of a goal.
    let Some(constraint) = named.constraint.without_parameters() else { return Ok(true) };
    let fixed = NamedConstraint { name: named.name.clone(), constraint };
    hold(robot, &fixed, motion, file, frames, &mut scratch, work)?;
    Ok(scratch.passed())
}

/// Proves a constraint along a motion, its parameters against the first knot.
fn hold(
    robot: &Robot,
    named: &NamedConstraint,
    motion: &SegmentMotion<'_>,
    file: &PathFile,
    frames: &Frames,
    report: &mut CheckReport,
    work: &mut Work,
) -> Result<(), CheckError> {
    let tolerance = file.certificate.path_tolerance;
    let reach = Reach::new(motion);
    let mut leaf = Leaf { motion, file, reach: &reach, report, work };
    let mut entries = Vec::new();
    if let Some(constraint) = named.constraint.without_parameters() {
        entries.extend(told(robot, &named.name, constraint, None, tolerance));
    }
    if let Some((constraint, argument)) = frozen_centre(&named.constraint, &leaf, frames, robot)? {
        entries.extend(told(robot, &named.name, constraint, Some(argument), FROM_THE_FIRST_KNOT * tolerance));
    }
    for entry in &entries {
        constraint::check(&mut leaf, entry, frames, "scene")?;
    }
    Ok(())
}

/// A constraint as entries of a path file.
pub(in crate::check::contract) fn told(
    robot: &Robot,
    name: &str,
    constraint: Constraint,
    argument: Option<Pose>,
    tolerance: f64,
) -> Vec<ConstraintEntry> {
    let requirement = PathConstraint { name: name.to_owned(), constraint, argument };
    constraint_entries(robot, &requirement, tolerance)
}

/// The parameter rows of a centre of mass, and where the first knot has it; none for other constraints.
fn frozen_centre(
    constraint: &Constraint,
    leaf: &Leaf<'_>,
    frames: &Frames,
    robot: &Robot,
) -> Result<Option<(Constraint, Pose)>, CheckError> {
    let Constraint::CentreOfMass(balanced) = constraint else { return Ok(None) };
    let mut frozen = balanced.clone();
    frozen.rows.retain(|plane| plane.row == Row::Parameter);
    if frozen.rows.is_empty() {
        return Ok(None);
    }
    frozen.reference = Reference::Argument(0);
    let constraint = Constraint::CentreOfMass(frozen);
    let entries = told(robot, "", constraint.clone(), Some(Pose::identity()), 0.0);
    let first = match entries.first() {
        Some(entry) => balance::first_centre(leaf, entry, frames)?,
        None => DVec3::ZERO,
    };
    Ok(Some((constraint, Pose::from_translation(first))))
}

/// Whether the constraints of a segment express what a scene requires.
pub(super) fn said(robot: &Robot, named: &NamedConstraint, file: &PathFile, segment: usize) -> Said {
    let tolerance = file.certificate.path_tolerance;
    let given = &file.segments[segment].constraints;
    let strict = |entry: &ConstraintEntry| entry.tolerance <= tolerance * (1.0 + SAME);
    if !named.constraint.foliates() {
        let wanted = told(robot, &named.name, named.constraint.clone(), None, tolerance);
        let exactly = wanted.iter().all(|entry| given.iter().any(|other| strict(other) && same_entry(entry, other)));
        return if exactly { Said::Exactly } else { Said::No };
    }
    let alike_are = |argument: Pose| {
        let wanted = told(robot, &named.name, named.constraint.clone(), Some(argument), tolerance);
        wanted.iter().all(|entry| given.iter().any(|other| strict(other) && alike(entry, other)))
    };
    let exactly = |argument: Pose| {
        let wanted = told(robot, &named.name, named.constraint.clone(), Some(argument), tolerance);
        wanted.iter().all(|entry| given.iter().any(|other| strict(other) && same_entry(entry, other)))
    };
    // Where the leaf has the parameters is free, and the file says it: some value of its own makes its entries.
    let said = match &named.constraint {
        Constraint::RelativePose(pose) => {
            let values = given.iter().filter_map(|entry| entry.value.and_then(pose_from_array));
            values.filter(|value| fits(pose, value)).any(exactly)
        }
        Constraint::Locked(_) => {
            let values = given.iter().filter_map(|entry| entry.position);
            values.map(|value| Pose::from_translation(DVec3::X * value)).any(exactly)
        }
        _ => return if alike_are(Pose::identity()) { Said::Loosely } else { Said::No },
    };
    if said { Said::Exactly } else { Said::No }
}

/// Whether a value for the parameters has the zero rows at zero and keeps the bounded ones.
fn fits(constraint: &RelativePose, value: &Pose) -> bool {
    let errors = [value.translation.to_array(), log_so3(value.rotation).to_array()].concat();
    errors.iter().zip(&constraint.rows).all(|(error, row)| match row {
        Some(Row::Zero) => error.abs() <= NEAR,
        Some(Row::Inequality) => *error >= -NEAR,
        Some(Row::Parameter) | None => true,
    })
}

/// The same kind about the same frames and rows, whatever the value.
fn alike(a: &ConstraintEntry, b: &ConstraintEntry) -> bool {
    let planes = a.planes.len() == b.planes.len()
        && a.planes.iter().zip(&b.planes).all(|(x, y)| x.inequality == y.inequality && near(&x.normal, &y.normal));
    a.kind == b.kind
        && same_frame(&a.frame, &b.frame)
        && same_frame(&a.to, &b.to)
        && (a.mask, a.inequality, a.bound) == (b.mask, b.inequality, b.bound)
        && a.parts == b.parts
        && a.joint == b.joint
        && planes
}

fn same_entry(a: &ConstraintEntry, b: &ConstraintEntry) -> bool {
    let number = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= SAME,
        (None, None) => true,
        _ => false,
    };
    let value = match (a.value.and_then(pose_from_array), b.value.and_then(pose_from_array)) {
        (Some(a), Some(b)) => same_pose(&a, &b),
        (None, None) => a.value.is_some() == b.value.is_some(),
        _ => false,
    };
    let planes = a.planes.iter().zip(&b.planes).all(|(x, y)| (x.offset - y.offset).abs() <= SAME);
    let numbers = number(a.height, b.height)
        && number(a.length, b.length)
        && number(a.position, b.position)
        && number(a.within, b.within);
    alike(a, b) && value && planes && numbers
}

fn same_frame(a: &Option<FrameEntry>, b: &Option<FrameEntry>) -> bool {
    let read = |frame: &FrameEntry| {
        let (name, pose) = frame.parts();
        Some((name.to_owned(), pose.map_or(Some(Pose::identity()), |row| pose_from_array(*row))?))
    };
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => {
            read(a).zip(read(b)).is_some_and(|((one, pose), (other, at))| one == other && same_pose(&pose, &at))
        }
        _ => false,
    }
}

fn near(a: &[f64; 3], b: &[f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME)
}
