//! Two points at a distance, or no nearer or no farther.

use super::placement_of;
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
