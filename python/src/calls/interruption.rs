//! Long calls: other threads of Python go on meanwhile, Ctrl-C ends them.

use crate::calls::{errors, workers};
use foliate::crossbeam_channel::{RecvTimeoutError, bounded};
use foliate::prelude::CancelToken;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

/// So often Python is asked whether Ctrl-C was pressed.
pub(crate) const PATIENCE: Duration = Duration::from_millis(20);

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

/// Works on another thread. Meanwhile other threads of Python run; signals are looked at, and `tick` is called, every 20 ms. Where one of the two
/// raises, `cancel` is called, which makes the work end soon; the exception is raised once it has.
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    cancel: impl Fn(),
    work: impl FnOnce() -> T + Send + 'static,
    mut tick: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    let (done, ended) = bounded(1);
    workers::run(Box::new(move || {
        let value = catch_unwind(AssertUnwindSafe(work));
        // Somebody waits for it: `watched` does not return before.
        let _ = done.send(value);
    }));
    let mut raised = None;
    let value = loop {
        match py.detach(|| ended.recv_timeout(PATIENCE)) {
            Err(RecvTimeoutError::Timeout) => {
                if raised.is_none()
                    && let Err(why) = py.check_signals().and_then(|()| tick(py))
                {
                    cancel();
                    raised = Some(why);
                }
            }
            Ok(value) => break value,
            Err(RecvTimeoutError::Disconnected) => break Err(Box::new("a worker was lost") as Box<dyn Any + Send>),
        }
    };
    match (raised, value) {
        (Some(why), _) => Err(why),
        (None, Ok(value)) => Ok(value),
        (None, Err(payload)) => Err(errors::of_panic(&*payload)),
    }
}
