//! A host's own function of the poses of some frames.

use super::placement_of;
use foliate_components::Pose;
use foliate_components::constraint::Custom;

/// The rows where the bodies are.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn value(own: &Custom, X_WJ: &[Pose]) -> Vec<f64> {
    let X_WF: Vec<Pose> = own.0.frames().iter().map(|frame| placement_of(frame).in_world(X_WJ)).collect();
    let mut values = vec![0.0; own.0.rows().len()];
    own.0.value(&X_WF, &mut values);
    values
}
