//! How much reading may take: a signal that stops it, and memory.

use crate::scene::reading::error::{LoadStop, SceneError};
use foliate_systems::events::StopSignal;

/// What a host allows reading to take. By default all that it needs, within the caps on every file.
#[derive(Clone, Debug, Default)]
pub struct LoadLimits {
    /// Stops it: a deadline, the host's token, the host's watch over memory.
    pub stop: StopSignal,
    /// Most bytes that meshes may take together while they are read, estimated before each is; none for as many as there are.
    pub mesh_bytes: Option<u64>,
}

impl LoadLimits {
    /// Why reading has to stop, if it has.
    pub(crate) fn reached(&self, at: &str) -> Result<(), SceneError> {
        look(&self.stop, at)
    }
}

/// The error that reading ends with, where the signal is raised.
pub(crate) fn look(signal: &StopSignal, at: &str) -> Result<(), SceneError> {
    match stopped_by(signal) {
        None => Ok(()),
        Some(stop) => Err(SceneError::stopped(at, stop)),
    }
}

fn stopped_by(signal: &StopSignal) -> Option<LoadStop> {
    if !signal.is_raised() {
        return None;
    }
    Some(if signal.token.is_cancelled() {
        LoadStop::Cancelled
    } else if signal.is_out_of_memory() {
        LoadStop::Memory
    } else {
        LoadStop::Deadline
    })
}

impl SceneError {
    /// That reading was stopped, at a file.
    pub(crate) fn stopped(at: &str, stop: LoadStop) -> Self {
        let message = match stop {
            LoadStop::Deadline => "the time limit was reached while this was read",
            LoadStop::Cancelled => "reading was cancelled here",
            LoadStop::Memory => "the memory limit was reached while this was read",
        };
        Self { stopped: Some(stop), ..Self::new(at, "file", message) }
    }
}
