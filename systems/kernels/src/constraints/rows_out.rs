//! Where a constraint writes its rows, and what all kinds share: references, satisfied inequalities, frames as kinematics
//! names them.

use crate::kinematics::Placement;
use foliate_components::Pose;
use foliate_components::constraint::{Frame, Reference, Row};

/// The frame of a constraint as kinematics names it.
#[must_use]
pub fn placement_of(frame: &Frame) -> Placement {
    Placement { joint: frame.joint, X_JF: frame.joint_from_frame }
}

/// The reference pose itself.
pub(crate) fn reference_of(reference: Reference, arguments: &[Pose]) -> Pose {
    match reference {
        Reference::Identity => Pose::identity(),
        Reference::Fixed(pose) => pose,
        Reference::Argument(slot) => arguments[slot],
    }
}

/// Whether a row has nothing to say: a satisfied inequality.
pub(crate) fn is_silent(row: Row, value: f64) -> bool {
    row == Row::Inequality && value >= 0.0
}

/// Zeroes the values of satisfied inequalities.
pub(crate) fn silence(values: &mut [f64], rows: impl IntoIterator<Item = Row>) {
    for (value, row) in values.iter_mut().zip(rows) {
        if is_silent(row, *value) {
            *value = 0.0;
        }
    }
}

/// Where a constraint writes its rows: values, and a Jacobian column by column (a coordinate's numbers lie together: that
/// is how they are summed up, and how a coordinate is frozen). The Jacobian must be zero before.
#[derive(Debug)]
pub struct RowsOut<'a> {
    /// One value per row.
    pub values: &'a mut [f64],
    /// The derivative of row r by column c is at c · `stride` + r. Empty where values alone are asked for.
    pub jacobian: &'a mut [f64],
    /// From one column to the next; at least the number of rows.
    pub stride: usize,
}
