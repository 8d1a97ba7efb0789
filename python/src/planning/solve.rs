//! Planning: a scene in, a solution out.

use crate::calls::errors;
use crate::calls::interruption::{PyCancel, watched};
use crate::planning::report::PyReport;
use crate::planning::request::Request;
use crate::planning::solution::PySolution;
use crate::scene::py_scene::PyScene;
use foliate::NoSolution;
use foliate::crossbeam_channel::Receiver;
use foliate::prelude::{CancelToken, SearchEvent, SolveEvent};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::time::{Duration, Instant};

/// `progress` is called this often at most.
const PROGRESS: Duration = Duration::from_millis(100);

/// Plans a path for a scene.
///
/// The answer depends on scene, seed and settings alone, not on `threads` or the machine. `time_limit` is in seconds. `improve_work` is how much counted
/// work is spent on a better path than the first, `improve_time` seconds instead; `first` asks for the first path, without times. `candidates` is how many
/// candidates a step has. `progress` is called with a dictionary (`step`, `candidates`, `nodes`, `edges`, `leaves`) at most ten times a second; what it raises
/// ends the search. `cancel` ends it from another thread. Other threads of Python run meanwhile; Ctrl-C ends the search.
///
/// Raises `NoSolution` where there is no path, with the reason and what the search did; `ModelError` where the problem cannot be planned for; `ValueError` for
/// a value that no option has.
#[pyfunction]
#[pyo3(signature = (scene, *, seed = 1, time_limit = 60.0, threads = 1, scheduler = "sequence", first = false, improve_work = None,
    improve_time = None, candidates = 16, memory_limit = None, progress = None, cancel = None))]
#[allow(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn solve(
    py: Python<'_>,
    scene: Py<PyScene>,
    seed: u64,
    time_limit: f64,
    threads: u16,
    scheduler: &str,
    first: bool,
    improve_work: Option<u64>,
    improve_time: Option<f64>,
    candidates: u16,
    memory_limit: Option<&str>,
    progress: Option<Py<PyAny>>,
    cancel: Option<&PyCancel>,
) -> PyResult<PySolution> {
    let request = Request::of(
        (seed, time_limit, threads, scheduler),
        (first, improve_work, improve_time),
        (candidates, memory_limit),
    )?;
    let token = cancel.map_or_else(CancelToken::default, |cancel| cancel.token.clone());
    let begun = Instant::now();
    let shared = scene.get();
    let model = py.detach(|| shared.model()).map_err(|why| errors::of_model(py, &why))?;
    let planner = request.planner(model, begun, &token);
    let (planner, mut told) = match progress {
        Some(function) => {
            let (planner, events) = planner.events();
            (planner, Some(Progress { function, events, last: None }))
        }
        None => (planner, None),
    };
    let tick = |py: Python<'_>| told.as_mut().map_or(Ok(()), |told| told.tell(py));
    let threads = request.threads();
    let answer = watched(py, || token.cancel(), move || planner.solve_on(threads), tick)?;
    match answer {
        Ok(solution) => Ok(PySolution::new(solution, scene, request.label())),
        Err(none) => Err(without_path(py, &none)),
    }
}

/// What a search without a path raises.
pub(crate) fn without_path(py: Python<'_>, none: &NoSolution) -> PyErr {
    let report = match Py::new(py, PyReport::of(&none.report)) {
        Ok(report) => report,
        Err(why) => return why,
    };
    errors::raised(py, "NoSolution", (none.reason.to_string(), none.reason.name(), none.reason.detail(), report))
}

/// What is told of progress, and when it was last.
struct Progress {
    function: Py<PyAny>,
    events: Receiver<SolveEvent>,
    last: Option<Instant>,
}

impl Progress {
    fn tell(&mut self, py: Python<'_>) -> PyResult<()> {
        if self.last.is_some_and(|last| last.elapsed() < PROGRESS) {
            return Ok(());
        }
        let news = self.events.try_iter().filter_map(|told| match told.event {
            SearchEvent::Progress { step, candidates, nodes, edges, leaves } => {
                Some((step, candidates, nodes, edges, leaves))
            }
            _ => None,
        });
        let Some((step, candidates, nodes, edges, leaves)) = news.last() else { return Ok(()) };
        self.last = Some(Instant::now());
        let numbers = PyDict::new(py);
        numbers.set_item("step", step)?;
        numbers.set_item("candidates", candidates)?;
        numbers.set_item("nodes", nodes)?;
        numbers.set_item("edges", edges)?;
        numbers.set_item("leaves", leaves)?;
        self.function.call1(py, (numbers,)).map(drop)
    }
}
