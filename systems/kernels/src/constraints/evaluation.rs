//! Any constraint at given poses of bodies, on its own: how far it is from holding, and which leaf the bodies are on.
//!
//! This is for classifying and checking configurations. A solve compiles its constraints instead.

use super::{centre_of_mass, com_between, custom, distance, placement, relative_pose};
use crate::constraints::rows_out::placement_of;
use crate::kinematics::joint_table::JointCoordinates;
use foliate_components::Pose;
use foliate_components::constraint::{
    CentreOfMass, Constraint, LockedValue, Placement, PlaneRow, Reference, RelativePose, Row, parameter_of,
};
use foliate_components::robot::{JointIndex, Robot};
use glam::DVec3;

/// The largest row in absolute value at configuration `q`; metres and radians. Rows that are parameters do not count,
/// satisfied inequalities count zero, violated ones their depth. Infinite where a row is not a number.
///
/// `X_WJ` are the poses of all bodies at `q`, carried objects where their carriers take them.
///
/// # Panics
/// If a slice is too short or the constraint names joints that the robot does not have.
#[must_use]
pub fn residual(robot: &Robot, constraint: &Constraint, q: &[f64], X_WJ: &[Pose]) -> f64 {
    match constraint {
        Constraint::RelativePose(pose) => largest(&pose.rows, &relative_pose_value(pose, X_WJ)),
        Constraint::Placement(placement) | Constraint::PlacementHold(placement, _) => contact(placement, X_WJ),
        Constraint::PlacementComplement(..) => 0.0,
        Constraint::Locked(locked) => match locked.value {
            LockedValue::Fixed(value) => finite_or_infinite((coordinate(robot, locked.joint, q) - value).abs()),
            LockedValue::Argument(_) => 0.0,
        },
        Constraint::CentreOfMass(balance) => centre_residual(balance, X_WJ),
        Constraint::Tilt(tilt) => centre_residual(&tilt.as_weighted_sum(), X_WJ),
        Constraint::Region(region) => centre_residual(&region.as_weighted_sum(), X_WJ),
        Constraint::CentreOfMassBetween(balance) => {
            let mut values = [0.0; 4];
            let count = com_between::dimension(balance);
            com_between::value(balance, X_WJ, &mut values[..count]);
            let row = |k: usize| depth(Some(com_between::kind(balance, k)), values[k]);
            (0..count).map(row).fold(0.0, f64::max)
        }
        Constraint::Distance(apart) => depth(Some(apart.row), distance::value(apart, X_WJ)),
        Constraint::Custom(own) => {
            let (rows, values) = (own.0.rows(), custom::value(own, X_WJ));
            rows.iter().zip(values).map(|(&row, value)| depth(Some(row), value)).fold(0.0, f64::max)
        }
    }
}

/// The argument that makes the parameter rows zero where the bodies are, neutral in every other row: two configurations
/// are on one leaf where it is the same pose. The identity for constraints without parameter rows.
///
/// A locked joint's value is the x of the translation. Where the reference of a relative pose is fixed, rows that are zero
/// at it are zero at the argument too: the argument takes the reference's place.
///
/// # Panics
/// If a slice is too short or the constraint names joints that the robot does not have.
#[must_use]
pub fn parameter(robot: &Robot, constraint: &Constraint, q: &[f64], X_WJ: &[Pose]) -> Pose {
    match constraint {
        Constraint::RelativePose(pose) => relative_pose_parameter(pose, X_WJ),
        Constraint::PlacementComplement(placement, _) | Constraint::PlacementHold(placement, _) => {
            placement::parameter(placement, X_WJ)
        }
        Constraint::Locked(locked) => Pose::from_translation(DVec3::X * coordinate(robot, locked.joint, q)),
        Constraint::CentreOfMass(balance) => centre_of_mass::parameter(balance, X_WJ),
        Constraint::Placement(_)
        | Constraint::CentreOfMassBetween(_)
        | Constraint::Distance(_)
        | Constraint::Tilt(_)
        | Constraint::Region(_)
        | Constraint::Custom(_) => Pose::identity(),
    }
}

fn centre_residual(balance: &CentreOfMass, X_WJ: &[Pose]) -> f64 {
    let center = centre_of_mass::in_frame(balance, X_WJ);
    let row = |plane: &PlaneRow| depth(Some(plane.row), centre_of_mass::row(plane, center, DVec3::ZERO));
    balance.rows.iter().map(row).fold(0.0, f64::max)
}

/// What a row adds to a residual.
fn depth(row: Option<Row>, value: f64) -> f64 {
    match row {
        None | Some(Row::Parameter) => 0.0,
        Some(Row::Zero) => finite_or_infinite(value.abs()),
        Some(Row::Inequality) => finite_or_infinite((-value).clamp(0.0, f64::INFINITY)),
    }
}

fn finite_or_infinite(value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { value }
}

fn largest(rows: &[Option<Row>], values: &[f64]) -> f64 {
    rows.iter().zip(values).map(|(&row, &value)| depth(row, value)).fold(0.0, f64::max)
}

/// What stands still whatever the leaf is.
fn fixed_reference(pose: &RelativePose) -> Pose {
    match pose.reference {
        Reference::Fixed(reference) => reference,
        Reference::Identity | Reference::Argument(_) => Pose::identity(),
    }
}

fn relative_pose_value(pose: &RelativePose, X_WJ: &[Pose]) -> [f64; 6] {
    relative_pose::value(&placement_of(&pose.a), &placement_of(&pose.b), &fixed_reference(pose), X_WJ)
}

fn relative_pose_parameter(pose: &RelativePose, X_WJ: &[Pose]) -> Pose {
    let X_AB = relative_pose::pose(&placement_of(&pose.a), &placement_of(&pose.b), X_WJ);
    if !matches!(pose.reference, Reference::Fixed(_)) {
        return parameter_of(&pose.rows, &X_AB);
    }
    let reference = fixed_reference(pose);
    let apart =
        Pose::from_parts(X_AB.translation - reference.translation, reference.rotation.conjugate() * X_AB.rotation);
    let kept = parameter_of(&pose.rows, &apart);
    Pose::from_parts(reference.translation + kept.translation, reference.rotation * kept.rotation)
}

fn contact(contact: &Placement, X_WJ: &[Pose]) -> f64 {
    let values = placement::value(contact, placement::contact(contact, X_WJ), X_WJ);
    largest(&[Some(Row::Zero); 5], &values)
}

fn coordinate(robot: &Robot, joint: JointIndex, q: &[f64]) -> f64 {
    JointCoordinates::of(robot, &robot.joints[joint.at()]).value(q)
}
