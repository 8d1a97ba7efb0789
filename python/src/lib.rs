//! The Python package `foliate`: scenes, plans, and paths as numpy arrays.
//!
//! `scene` is what is planned for, made of a `document` or by `setup`, with each `solid` of its links, `planning` plans, `solution` and `report` are what comes of it, `path` answers what a robot program or a notebook asks of a path,
//! `checking` proves a path file, `command` is the program `foliate`. `errors` makes exceptions of errors, `interruption` lets Ctrl-C end what takes long, on `workers`, `arrays` fills numpy arrays, `page` shows.

mod arrays;
mod checking;
mod command;
mod document;
mod errors;
mod interruption;
mod page;
mod path;
mod planning;
mod report;
mod scene;
mod setup;
mod solid;
mod solution;
mod workers;

use pyo3::prelude::pymodule;

/// A search asks for many small pieces of memory.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The compiled part of the package `foliate`.
#[pymodule(name = "_foliate")]
mod module {
    #[pymodule_export]
    use crate::checking::{PyCheckReport, check};
    #[pymodule_export]
    use crate::command::run_program;
    #[pymodule_export]
    use crate::interruption::PyCancel;
    #[pymodule_export]
    use crate::path::{PyEvent, PyPath, PySegment, load_path};
    #[pymodule_export]
    use crate::planning::{schedulers, solve};
    #[pymodule_export]
    use crate::report::{PyFunnelRow, PyReport};
    #[pymodule_export]
    use crate::scene::{PyScene, scenes};
    #[pymodule_export]
    use crate::setup::{PyNewScene, new_scene};
    #[pymodule_export]
    use crate::solid::PySolid;
    #[pymodule_export]
    use crate::solution::PySolution;

    /// Version of Foliate.
    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "the name that Python looks for")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
