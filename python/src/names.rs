//! Names of what a robot model has.

use crate::calls::errors;
use foliate::components::robot::{Joint, PartKind, Robot};
use pyo3::prelude::*;

/// Names of parts.
pub(crate) fn of_parts(model: &Robot, kind: PartKind) -> Vec<String> {
    model.parts.iter().filter(|part| part.kind == kind).map(|part| part.name.clone()).collect()
}

/// Names of some of a robot's joints of one coordinate, depth first.
pub(crate) fn of_joints(
    py: Python<'_>,
    model: &Robot,
    robot: &str,
    is_wanted: impl Fn(&Joint) -> bool,
) -> PyResult<Vec<String>> {
    let part = model.parts.iter().find(|part| part.name == robot && part.kind == PartKind::Robot);
    let joints = &model.joints[part.ok_or_else(|| errors::unknown(py, "robot", robot))?.joints.clone()];
    let wanted = joints.iter().filter(|joint| joint.motion.configuration_size() == 1 && is_wanted(joint));
    Ok(wanted.map(|joint| joint.name.clone()).collect())
}
