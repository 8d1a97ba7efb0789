//! Planar and floating joints that a model has itself: a mobile base, an object that is part of the robot. A URDF gives them no bounds.

use crate::setup::new_scene::request::DRIVES;
use foliate_components::robot::JointType;
use foliate_components::robot::model::{JointKind, Model};

/// Bounds of these joints by number, as `joint/x`: a planar joint moves within [`DRIVES`] metres of zero along x and y, a floating one
/// stands still at zero.
pub(super) fn bounds(model: &Model) -> Vec<(String, f64, f64)> {
    let of_joint = |joint: &foliate_components::robot::model::JointModel| {
        let numbers: Vec<(f64, f64)> = match joint.kind {
            JointKind::Planar => vec![(-DRIVES, DRIVES); 2],
            JointKind::Floating => [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].map(|x| (x, x)).to_vec(),
            _ => Vec::new(),
        };
        let axes = if joint.kind == JointKind::Planar { JointType::Planar } else { JointType::FreeFlyer }.axes();
        let name = joint.name.clone();
        axes.iter()
            .zip(numbers)
            .map(move |(axis, (low, high))| (format!("{name}/{axis}"), low, high))
            .collect::<Vec<_>>()
    };
    model.joints.iter().flat_map(of_joint).collect()
}

/// Whether the model drives by a joint of its own.
pub(super) fn drives(model: &Model) -> bool {
    model.joints.iter().any(|joint| joint.kind == JointKind::Planar)
}

/// The joints of a kind, by name.
pub(super) fn of_kind(model: &Model, kind: JointKind) -> impl Iterator<Item = &str> {
    model.joints.iter().filter(move |joint| joint.kind == kind).map(|joint| joint.name.as_str())
}
