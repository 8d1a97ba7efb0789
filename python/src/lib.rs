//! The Python package `foliate`: scenes, plans, and paths as numpy arrays.
//!
//! `scene` is what is planned for, `planning` plans, `path` answers what a robot program or a notebook asks of a path, `checking` proves a path file,
//! `command` is the program `foliate`. `calls` runs what takes long, `arrays` fills numpy arrays, `names` lists what a model has, `page` shows.

mod arrays;
mod calls;
mod checking;
mod command;
mod names;
mod page;
mod path;
mod planning;
mod scene;

use pyo3::prelude::pymodule;

/// A search asks for many small pieces of memory.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The compiled part of the package `foliate`.
#[pymodule(name = "_foliate")]
mod module {
    #[pymodule_export]
    use crate::calls::interruption::PyCancel;
    #[pymodule_export]
    use crate::checking::{PyCheckReport, check};
    #[pymodule_export]
    use crate::command::run_program;
    #[pymodule_export]
    use crate::path::event::PyEvent;
    #[pymodule_export]
    use crate::path::py_path::{PyPath, load_path};
    #[pymodule_export]
    use crate::path::segment::PySegment;
    #[pymodule_export]
    use crate::planning::batch::PyBatch;
    #[pymodule_export]
    use crate::planning::report::{PyFunnelRow, PyReport};
    #[pymodule_export]
    use crate::planning::request::schedulers;
    #[pymodule_export]
    use crate::planning::solution::PySolution;
    #[pymodule_export]
    use crate::planning::solve::solve;
    #[pymodule_export]
    use crate::scene::new_scene::{PyNewScene, new_scene};
    #[pymodule_export]
    use crate::scene::py_scene::{PyScene, scenes};
    #[pymodule_export]
    use crate::scene::solid::PySolid;
    #[pymodule_export]
    use crate::scene::variations::PyVariations;

    /// Version of Foliate.
    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "the name that Python looks for")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
