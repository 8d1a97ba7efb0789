//! What a solve answers.

use crate::path::py_path::{PyPath, Source};
use crate::planning::report::PyReport;
use crate::scene::py_scene::PyScene;
use foliate::Solution;
use pyo3::prelude::*;
use std::sync::Arc;

/// A certified path, and what the search did to find it.
#[pyclass(frozen, name = "Solution", module = "foliate")]
pub struct PySolution {
    solution: Arc<Solution>,
    scene: Py<PyScene>,
    seed: u64,
    scheduler: String,
}

impl PySolution {
    pub(crate) fn new(solution: Solution, scene: Py<PyScene>, (seed, scheduler): (u64, String)) -> Self {
        Self { solution: Arc::new(solution), scene, seed, scheduler }
    }
}

#[pymethods]
impl PySolution {
    /// `"solved"`.
    #[getter]
    fn outcome(&self) -> &'static str {
        "solved"
    }

    /// The path.
    #[getter]
    fn path(&self, py: Python<'_>) -> PyPath {
        let source = Source::Solved {
            solution: Arc::clone(&self.solution),
            scene: self.scene.clone_ref(py),
            seed: self.seed,
            scheduler: self.scheduler.clone(),
        };
        PyPath { source }
    }

    /// What the search did.
    #[getter]
    fn report(&self) -> PyReport {
        PyReport::of(&self.solution.report)
    }

    /// What was planned for.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<PyScene> {
        self.scene.clone_ref(py)
    }

    /// The seed.
    #[getter]
    fn seed(&self) -> u64 {
        self.seed
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        self.path(py).framed(py)
    }

    fn __repr__(&self) -> String {
        let Solution { path, report, .. } = &*self.solution;
        let duration = path.duration().map_or(String::new(), |seconds| format!(", {seconds:.2} s long"));
        format!("Solution({} segments{duration}, found in {:.4} s)", path.segments.len(), report.time().as_secs_f64())
    }
}
