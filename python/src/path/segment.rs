//! The motions of a path.

use crate::arrays::{Array, matrix, row};
use foliate::components::path::Segment;
use pyo3::prelude::*;

/// A motion on one leaf.
#[pyclass(frozen, name = "Segment", module = "foliate")]
pub struct PySegment {
    pub(crate) segment: Segment,
    pub(crate) state: String,
    pub(crate) transition: String,
    pub(crate) holding: Vec<(String, String)>,
}

#[pymethods]
impl PySegment {
    /// Name of the state in which the motion lies.
    #[getter]
    fn state(&self) -> &str {
        &self.state
    }

    /// Name of the transition that is travelled.
    #[getter]
    fn transition(&self) -> &str {
        &self.transition
    }

    /// Who holds what during the motion: grippers (`part/gripper`) and handles (`part/handle`).
    #[getter]
    fn holding(&self) -> Vec<(String, String)> {
        self.holding.clone()
    }

    /// Configurations: an array of shape (knots, numbers of a configuration).
    #[getter]
    fn knots<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        matrix(py, self.segment.knots.concat(), self.segment.knots.first().map_or(0, Vec::len))
    }

    /// When the knots are passed, seconds: an array of shape (knots,). `None` in a path without times.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        self.segment.timing.as_ref().map(|timing| row(py, timing.times.clone()))
    }

    fn __repr__(&self) -> String {
        format!("Segment({:?}, {} knots)", self.state, self.segment.knots.len())
    }
}
