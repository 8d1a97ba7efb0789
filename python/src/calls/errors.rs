//! Exceptions: `foliate/errors.py` has their classes, with an attribute for each thing that an error says.

use foliate::planner::panic_message;
use foliate::scene::SceneError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// An exception of a class of `foliate.errors`.
pub(crate) fn raised<'py>(py: Python<'py>, class: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made = py.import("foliate.errors").and_then(|errors| errors.getattr(class)?.call1(arguments));
    match made {
        Ok(exception) => PyErr::from_value(exception),
        Err(why) => why,
    }
}

pub(crate) fn of_scene(py: Python<'_>, error: &SceneError) -> PyErr {
    let SceneError { file, line, element, message, hint, .. } = error;
    raised(py, "SceneError", (error.to_string(), file, *line, element, message, hint))
}

pub(crate) fn of_model(py: Python<'_>, error: &impl std::error::Error) -> PyErr {
    raised(py, "ModelError", (error.to_string(),))
}

/// A name that nothing has.
pub(crate) fn unknown(py: Python<'_>, what: &str, name: &str) -> PyErr {
    raised(py, "ModelError", (format!("there is no {what} `{name}`"),))
}

/// What is wrong with a path, its file or what is asked of it.
pub(crate) fn of_path(py: Python<'_>, error: &impl std::fmt::Display) -> PyErr {
    raised(py, "PathError", (error.to_string(),))
}

/// What a panic of the kernel becomes: the process lives on.
pub(crate) fn of_panic(payload: &(dyn std::any::Any + Send)) -> PyErr {
    PyRuntimeError::new_err(format!("a bug of foliate: {}", panic_message(payload)))
}
