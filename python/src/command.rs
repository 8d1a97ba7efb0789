//! The program `foliate`, for those who have the wheel and no Rust.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the program `foliate` with arguments, of which the first is its name; returns its exit code. It is the end of the process: signals are its own from
/// then on.
#[pyfunction]
pub fn run_program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| foliate::cli::run_program(arguments))
}
