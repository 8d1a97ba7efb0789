//! Two points at a distance, or no nearer or no farther.

use crate::constraints::rows_out::{RowsOut, is_silent, placement_of};
use crate::kinematics::Column;
use foliate_components::Pose;
use foliate_components::constraint::Distance;
use glam::DVec3;

/// From the first point to the second, in the world.
pub(super) fn between(distance: &Distance, X_WJ: &[Pose]) -> DVec3 {
    placement_of(&distance.b).in_world(X_WJ).translation - placement_of(&distance.a).in_world(X_WJ).translation
}

/// `|p_B − p_A| − length`, times −1 where at most that is allowed; metres.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn value(distance: &Distance, X_WJ: &[Pose]) -> f64 {
    sign(distance) * (between(distance, X_WJ).length() - distance.length)
}

pub(super) fn sign(distance: &Distance) -> f64 {
    if distance.at_most { -1.0 } else { 1.0 }
}

/// Writes the row and its Jacobian; `columns` are those of the second frame's body against the first's. A satisfied
/// inequality has value and Jacobian zero.
///
/// # Panics
/// If a slice is too short.
pub fn linearise(distance: &Distance, columns: &[Column], X_WJ: &[Pose], out: RowsOut<'_>) {
    let apart = between(distance, X_WJ);
    let length = apart.length();
    let value = sign(distance) * (length - distance.length);
    if is_silent(distance.row, value) {
        out.values[0] = 0.0;
        return;
    }
    out.values[0] = value;
    // Points that coincide part in any direction.
    let direction = sign(distance) * apart.try_normalize().unwrap_or(DVec3::X);
    let point = placement_of(&distance.b).in_world(X_WJ).translation;
    for column in columns {
        out.jacobian[column.variable() * out.stride] += direction.dot(column.twist(X_WJ, point).0);
    }
}
