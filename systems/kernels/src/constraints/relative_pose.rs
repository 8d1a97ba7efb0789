//! Frame B in frame A against a reference: six rows `[R_Aᵀ(p_B − p_A) − t_ref; log(R_refᵀ R_Aᵀ R_B)]`.

use crate::constraints::rows_out::RowsOut;
use crate::kinematics::{Column, Placement};
use foliate_components::Pose;
use foliate_components::constraint::{Row, Rows};
use foliate_components::pose::{log_so3, log_so3_jacobian};
use glam::{DMat3, DVec3};

/// The six rows; metres in the axes of A, radians in the axes of the reference.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn value(a: &Placement, b: &Placement, reference: &Pose, X_WJ: &[Pose]) -> [f64; 6] {
    let (translation, turn) = error(&a.in_world(X_WJ), &b.in_world(X_WJ), reference);
    [translation.x, translation.y, translation.z, turn.x, turn.y, turn.z]
}

#[inline]
fn error(X_WA: &Pose, X_WB: &Pose, reference: &Pose) -> (DVec3, DVec3) {
    let R_AW = X_WA.rotation.conjugate();
    let translation = R_AW * (X_WB.translation - X_WA.translation) - reference.translation;
    let turn = log_so3(reference.rotation.conjugate() * (R_AW * X_WB.rotation));
    (translation, turn)
}

/// The pose of B in A: what a leaf parameter is read from.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn pose(a: &Placement, b: &Placement, X_WJ: &[Pose]) -> Pose {
    a.in_world(X_WJ).inverse() * b.in_world(X_WJ)
}

/// The Jacobian of [`value`], six numbers per column.
///
/// # Panics
/// If a slice is too short.
pub fn jacobian(a: &Placement, b: &Placement, reference: &Pose, columns: &[Column], X_WJ: &[Pose], out: &mut [f64]) {
    out.fill(0.0);
    let mut values = [0.0; 6];
    let rows = RowsOut { values: &mut values, jacobian: out, stride: 6 };
    linearise(a, b, reference, &[Some(Row::Zero); 6], columns, X_WJ, rows);
}

/// Writes the rows that are not free, in order, with their Jacobian. A satisfied inequality has value and Jacobian zero.
///
/// # Panics
/// If a slice is too short.
pub fn linearise(
    a: &Placement,
    b: &Placement,
    reference: &Pose,
    rows: &Rows,
    columns: &[Column],
    X_WJ: &[Pose],
    out: RowsOut<'_>,
) {
    let (X_WA, X_WB) = (a.in_world(X_WJ), b.in_world(X_WJ));
    let (translation, turn) = error(&X_WA, &X_WB, reference);
    let R_AW = DMat3::from_quat(X_WA.rotation.conjugate());
    let turns = !columns.is_empty() && rows[3..].iter().any(Option::is_some);
    let rotation_rows = if turns {
        log_so3_jacobian(turn) * DMat3::from_quat(reference.rotation.conjugate()) * R_AW
    } else {
        DMat3::ZERO
    };
    let all = [translation.x, translation.y, translation.z, turn.x, turn.y, turn.z];
    // Where each of the six rows goes; satisfied inequalities keep their zero Jacobian.
    let (mut target, mut next) = ([usize::MAX; 6], 0);
    for k in 0..6 {
        let Some(row) = rows[k] else { continue };
        let satisfied = row == Row::Inequality && all[k] >= 0.0;
        out.values[next] = if satisfied { 0.0 } else { all[k] };
        if !satisfied {
            target[k] = next;
        }
        next += 1;
    }
    for column in columns {
        // Both frames' motions as seen at B's origin: what moves both cancels, and A's turning needs no extra term.
        let (linear, angular) = column.twist(X_WJ, X_WB.translation);
        let (linear, angular) = (R_AW * linear, rotation_rows * angular);
        let six = [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z];
        let numbers = &mut out.jacobian[column.variable() * out.stride..];
        for (&row, value) in target.iter().zip(six) {
            if row != usize::MAX {
                numbers[row] += value;
            }
        }
    }
}
