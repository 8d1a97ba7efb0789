//! The common centre of some masses in a frame: fixed or frozen components, or half-spaces that bound it.

use super::{placement_of, reference_of};
use foliate_components::Pose;
use foliate_components::constraint::{CentreOfMass, Masses, PlaneRow, Row};
use glam::DVec3;

/// The common centre of the masses in the world, metres.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn centre(masses: &Masses, X_WJ: &[Pose]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for heavy in masses.bodies() {
        let center = heavy.body.map_or(heavy.center, |body| X_WJ[body.at()].transform_point(heavy.center));
        sum += heavy.mass * center;
    }
    sum / masses.total()
}

/// The centre in the constraint's frame, metres.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn in_frame(balance: &CentreOfMass, X_WJ: &[Pose]) -> DVec3 {
    placement_of(&balance.frame).in_world(X_WJ).inverse_transform_point(centre(&balance.masses, X_WJ))
}

/// What a row says of a centre in the frame: `normal · c − offset`, parameter rows measured from `reference`; metres.
#[must_use]
pub fn row(plane: &PlaneRow, center: DVec3, reference: DVec3) -> f64 {
    let from = if plane.row == Row::Parameter { center - reference } else { center };
    plane.normal.dot(from) - plane.offset
}

/// All rows, in order; metres.
///
/// # Panics
/// If a slice is too short.
pub fn value(balance: &CentreOfMass, arguments: &[Pose], X_WJ: &[Pose], values: &mut [f64]) {
    let (center, reference) = (in_frame(balance, X_WJ), reference_of(balance.reference, arguments).translation);
    values.iter_mut().zip(&balance.rows).for_each(|(value, plane)| *value = row(plane, center, reference));
}

/// The argument that makes parameter rows zero where the bodies are: the shortest such translation, so that what the
/// parameter rows do not look at does not tell leaves apart.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn parameter(balance: &CentreOfMass, X_WJ: &[Pose]) -> Pose {
    let center = in_frame(balance, X_WJ);
    let mut axes: Vec<DVec3> = Vec::with_capacity(3);
    let mut sum = DVec3::ZERO;
    for plane in balance.rows.iter().filter(|plane| plane.row == Row::Parameter) {
        let across = axes.iter().fold(plane.normal, |left, &axis| left - axis * left.dot(axis));
        // Rows that repeat others add nothing.
        if across.length() > 1e-9 {
            let axis = across.normalize();
            let wanted = plane.normal.dot(center - sum) - plane.offset;
            sum += axis * (wanted / plane.normal.dot(axis));
            axes.push(axis);
        }
    }
    Pose::from_translation(sum)
}
