//! Many problems, planned side by side.

use crate::calls::errors;
use crate::calls::interruption::PATIENCE;
use crate::planning::request::Request;
use crate::planning::solution::PySolution;
use crate::planning::solve::without_path;
use crate::scene::py_scene::PyScene;
use crate::scene::variations::{NotDrawn, PyVariations};
use foliate::batch::Pool;
use foliate::prelude::CancelToken;
use foliate::systems::planning_model::ModelError;
use foliate::{NoSolution, Solution};
use pyo3::exceptions::{PyIndexError, PyOSError, PyValueError};
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Threads that plan for one problem each, and give the answers in the order of the problems. `plan_batch` is what programs use.
#[pyclass(frozen, name = "Batch", module = "foliate._foliate")]
pub struct PyBatch {
    /// None once it was closed.
    pool: Mutex<Option<Pool<Answer>>>,
    cancel: CancelToken,
}

/// What is planned for.
#[derive(FromPyObject)]
enum Asked {
    Scene(Py<PyScene>),
    Instance(Py<PyVariations>, u64),
}

/// The scene of an answer.
enum Posed {
    Given(Py<PyScene>),
    Drawn(Box<PyScene>),
}

/// What became of a problem.
enum Answer {
    Solved(Box<Solution>, Posed, (u64, String)),
    NoSolution(Box<NoSolution>),
    NotDrawn(NotDrawn),
    NoModel(ModelError),
}

#[pymethods]
impl PyBatch {
    /// So many threads, each of which plans for one problem at a time.
    #[new]
    fn new(threads: usize) -> PyResult<Self> {
        if threads == 0 {
            return Err(PyValueError::new_err("`threads` is at least 1"));
        }
        let pool = Pool::new(threads).map_err(|why| PyOSError::new_err(why.to_string()))?;
        Ok(Self { pool: Mutex::new(Some(pool)), cancel: CancelToken::default() })
    }

    /// Adds a problem: a scene, or what varies and the number of an instance, which is drawn by the thread that plans for it. The settings are those of `solve`.
    ///
    /// Raises `ValueError` for a value that no option has, and once the batch was closed.
    #[pyo3(signature = (problem, *, seed = 1, time_limit = 60.0, scheduler = "sequence", first = false, improve_work = None, improve_time = None,
        candidates = 16, memory_limit = None))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python function")]
    fn add(
        &self,
        problem: Asked,
        seed: u64,
        time_limit: f64,
        scheduler: &str,
        first: bool,
        improve_work: Option<u64>,
        improve_time: Option<f64>,
        candidates: u16,
        memory_limit: Option<&str>,
    ) -> PyResult<()> {
        let request = Request::of(
            (seed, time_limit, 1, scheduler),
            (first, improve_work, improve_time),
            (candidates, memory_limit),
        )?;
        let cancel = self.cancel.clone();
        self.open(|pool| pool.add(move || answer(problem, &request, &cancel)))
    }

    /// The answer to the problem that was added first, once it is there; what `solve` raises is raised.
    ///
    /// Raises `IndexError` where no problem is left.
    fn take(&self, py: Python<'_>) -> PyResult<PySolution> {
        loop {
            let made = py.detach(|| {
                // A panic of the kernel is that problem's: the others go on.
                catch_unwind(AssertUnwindSafe(|| self.open(|pool| (pool.take_within(PATIENCE), pool.is_empty()))))
            });
            match made.map_err(|payload| errors::of_panic(&*payload))?? {
                (Some(answer), _) => return answer.told(py),
                (None, true) => return Err(PyIndexError::new_err("no problem is left")),
                (None, false) => py.check_signals()?,
            }
        }
    }

    /// How many problems were added and not taken.
    fn __len__(&self) -> PyResult<usize> {
        self.open(|pool| pool.len())
    }

    /// Ends: problems that were not begun never are, searches that are under way end soon.
    fn close(&self, py: Python<'_>) {
        self.cancel.cancel();
        let pool = self.pool.lock().unwrap_or_else(PoisonError::into_inner).take();
        py.detach(|| drop(pool));
    }
}

impl PyBatch {
    fn open<T>(&self, work: impl FnOnce(&mut Pool<Answer>) -> T) -> PyResult<T> {
        let mut pool = self.pool.lock().unwrap_or_else(PoisonError::into_inner);
        pool.as_mut().map(work).ok_or_else(|| PyValueError::new_err("the batch was closed"))
    }
}

/// Plans for a problem, on a thread that does not hold Python's lock.
fn answer(asked: Asked, request: &Request, cancel: &CancelToken) -> Answer {
    let begun = Instant::now();
    let posed = match asked {
        Asked::Scene(scene) => Posed::Given(scene),
        Asked::Instance(variations, number) => match variations.get().draw(number) {
            Ok(scene) => Posed::Drawn(Box::new(scene)),
            Err(not_drawn) => return Answer::NotDrawn(not_drawn),
        },
    };
    let scene = match &posed {
        Posed::Given(scene) => scene.get(),
        Posed::Drawn(scene) => scene,
    };
    let model = match scene.model() {
        Ok(model) => model,
        Err(why) => return Answer::NoModel(why),
    };
    match request.planner(model, begun, cancel).solve_on(request.threads()) {
        Ok(solution) => Answer::Solved(Box::new(solution), posed, request.label()),
        Err(none) => Answer::NoSolution(Box::new(none)),
    }
}

impl Answer {
    /// As `solve` tells it.
    fn told(self, py: Python<'_>) -> PyResult<PySolution> {
        match self {
            Self::Solved(solution, posed, label) => {
                let scene = match posed {
                    Posed::Given(scene) => scene,
                    Posed::Drawn(scene) => Py::new(py, *scene)?,
                };
                Ok(PySolution::new(*solution, scene, label))
            }
            Self::NoSolution(none) => Err(without_path(py, &none)),
            Self::NotDrawn(why) => Err(why.told(py)),
            Self::NoModel(why) => Err(errors::of_model(py, &why)),
        }
    }
}
