//! Proofs of path files.

use crate::calls::errors;
use crate::calls::interruption::watched;
use crate::scene::py_scene::PyScene;
use foliate::check::{CheckOptions, CheckReport, SceneChoice, Verdict, check as prove, check_problem};
use foliate::path_file::save;
use foliate::prelude::PackagePath;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// What `check` has found.
#[pyclass(frozen, name = "CheckReport", module = "foliate")]
pub struct PyCheckReport {
    report: CheckReport,
}

#[pymethods]
impl PyCheckReport {
    /// `"proved"`, `"refused"`, `"relative"` (proved, but only relative to what the file says of itself) or `"undecided"`.
    #[getter]
    fn verdict(&self) -> &'static str {
        self.report.verdict().name()
    }

    /// Whether everything is proved, against a scene.
    #[getter]
    fn proved(&self) -> bool {
        self.report.verdict() == Verdict::Proved
    }

    /// Broken promises, in words.
    #[getter]
    fn violations(&self) -> Vec<String> {
        self.report.violations.iter().map(ToString::to_string).collect()
    }

    /// Why what is proved is less than an answer to a scene.
    #[getter]
    fn weaker(&self) -> Vec<String> {
        self.report.weaker.clone()
    }

    /// Remarks.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.report.notes.clone()
    }

    /// Proven lower bound of the clearance along the whole path, metres, where it was asked for.
    #[getter]
    fn clearance(&self) -> Option<f64> {
        self.report.clearance
    }

    /// Everything, as `foliate check --json` says it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(&self.report).map_err(|why| PyValueError::new_err(why.to_string()))?;
        py.import("json")?.call_method1("loads", (text,))
    }

    fn __bool__(&self) -> bool {
        self.proved()
    }

    fn __repr__(&self) -> String {
        match self.report.violations.as_slice() {
            [] => format!("CheckReport({})", self.verdict()),
            [first, ..] => format!("CheckReport({}: {first})", self.verdict()),
        }
    }
}

/// Proves a path file over the continuum, by code that shares nothing with the search.
///
/// `scene` is what the path has to answer: a `Scene`, a scene's name or file. Without it, it is the scene that the file names. `time_limit` is in seconds;
/// what is not decided by then counts as undecided. `clearance` asks for a proven bound of the smallest clearance.
///
/// Other threads of Python run meanwhile; Ctrl-C ends the check.
///
/// Raises `PathError` where the file or a model cannot be read.
#[pyfunction]
#[pyo3(signature = (file, scene = None, *, time_limit = 600.0, clearance = false, packages = Vec::new()))]
pub fn check(
    py: Python<'_>,
    file: PathBuf,
    scene: Option<Against>,
    time_limit: f64,
    clearance: bool,
    packages: Vec<PathBuf>,
) -> PyResult<PyCheckReport> {
    let limit = Duration::try_from_secs_f64(time_limit)
        .map_err(|_| PyValueError::new_err(format!("time_limit: {time_limit} is not a number of seconds")))?;
    let packages = PackagePath::from_environment(&packages);
    let choice = match &scene {
        Some(Against::Named(name)) => SceneChoice::Given(name.clone()),
        Some(Against::Scene(_)) | None => SceneChoice::Named,
    };
    let cancelled = Arc::new(AtomicBool::new(false));
    let asked = Some(Arc::clone(&cancelled));
    let options =
        CheckOptions { time_limit: Some(limit), cancelled: asked, scene: choice, clearance, ..CheckOptions::default() };
    let read = save::read(&file).map_err(|why| errors::of_path(py, &why))?;
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let base = folder.unwrap_or(Path::new(".")).to_owned();
    let problem = match &scene {
        Some(Against::Scene(scene)) => Some(scene.get().scene.problem.clone()),
        Some(Against::Named(_)) | None => None,
    };
    let work = move || match problem {
        Some(problem) => check_problem(&read, &base, &packages, &options, &problem),
        None => prove(&read, &base, &packages, &options),
    };
    let report = watched(py, || cancelled.store(true, Ordering::Relaxed), work, |_| Ok(()))?
        .map_err(|why| errors::of_path(py, &why))?;
    Ok(PyCheckReport { report })
}

/// What a path has to answer.
#[derive(FromPyObject)]
pub enum Against {
    /// A scene.
    Scene(Py<PyScene>),
    /// The name of a shipped scene, or a file.
    Named(String),
}
