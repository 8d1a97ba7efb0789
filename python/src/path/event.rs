//! When hands take and let go.

use foliate::components::path::EventKind;
use foliate::trajectory::TrajectoryEvent;
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// A hand takes or lets go of an object.
#[pyclass(frozen, get_all, name = "Event", module = "foliate")]
pub struct PyEvent {
    /// Seconds, as the path counts them.
    time: f64,
    /// How long the robot stands still then, seconds.
    dwell: f64,
    /// `"grasp"` or `"release"`.
    kind: &'static str,
    /// The part that is taken or let go.
    object: String,
    /// `part/gripper`.
    gripper: String,
    /// `part/handle`.
    handle: String,
    /// Number of the segment that begins with it.
    segment: usize,
    /// Joints of the gripper and where they are when the hand has closed or opened, radians or metres.
    fingers: BTreeMap<String, f64>,
}

impl PyEvent {
    pub(crate) fn of(event: TrajectoryEvent<'_>) -> Self {
        Self {
            time: event.time,
            dwell: event.dwell,
            kind: match event.kind {
                EventKind::Grasp => "grasp",
                EventKind::Release => "release",
            },
            object: event.object.to_owned(),
            gripper: event.gripper.to_owned(),
            handle: event.handle.to_owned(),
            segment: event.segment,
            fingers: event.fingers.iter().map(|&(name, value)| (name.to_owned(), value)).collect(),
        }
    }
}

#[pymethods]
impl PyEvent {
    fn __repr__(&self) -> String {
        let Self { time, kind, object, gripper, .. } = self;
        format!("Event({time:.3} s: {kind} {object:?} by {gripper:?})")
    }
}
