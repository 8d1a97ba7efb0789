//! Long calls: other threads of Python go on meanwhile, Ctrl-C ends them.

use crate::errors;
use foliate::crossbeam_channel::{RecvTimeoutError, bounded};
use foliate::prelude::CancelToken;
use pyo3::prelude::*;
use std::time::Duration;

/// So often Python is asked whether Ctrl-C was pressed.
const PATIENCE: Duration = Duration::from_millis(20);

/// Ends solves from another thread.
///
/// One may be given to any number of solves. They end with `NoSolution`, whose reason is `cancelled`.
#[pyclass(frozen, name = "Cancel", module = "foliate")]
#[derive(Default)]
pub struct PyCancel {
    pub(crate) token: CancelToken,
}

#[pymethods]
impl PyCancel {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Ends the solves that have been given this, and those that will be.
    fn cancel(&self) {
        self.token.cancel();
    }

    /// Whether `cancel` was called.
    #[getter]
    fn is_cancelled(&self) -> bool {
        self.token.is_cancelled()
    }
}

/// Works on a thread of its own. Meanwhile other threads of Python run; signals are looked at, and `tick` is called, every 20 ms. Where one of the two
/// raises, `token` is cancelled and the exception is raised once the work has ended.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    token: &CancelToken,
    work: impl FnOnce() -> T + Send,
    mut tick: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    std::thread::scope(|scope| {
        let (done, ended) = bounded::<()>(1);
        let worker = scope.spawn(move || {
            let value = work();
            drop(done);
            value
        });
        let mut raised = None;
        while let Err(RecvTimeoutError::Timeout) = py.detach(|| ended.recv_timeout(PATIENCE)) {
            if raised.is_none()
                && let Err(why) = py.check_signals().and_then(|()| tick(py))
            {
                token.cancel();
                raised = Some(why);
            }
        }
        let value = py.detach(|| worker.join());
        match (raised, value) {
            (Some(why), _) => Err(why),
            (None, Ok(value)) => Ok(value),
            (None, Err(payload)) => Err(errors::of_panic(&*payload)),
        }
    })
}
