//! The C interface of Foliate: load a scene, set starts and goals, solve with a deadline and a way to cancel, read the trajectory.
//!
//! `include/foliate.h` is made of this source by cbindgen; a test compares them. Handles are opaque. Who gets one frees it with the function named after it.
//! Every call that can fail returns a [`FoliateStatus`](error::FoliateStatus); [`foliate_error`](error::foliate_error) says in words what was wrong with the last one of the thread. Nothing unwinds into C: a panic, which is a
//! bug, becomes `FOLIATE_STATUS_BUG`.
//!
//! `scene` is what is planned for, `solve` plans, `path` is what comes of it, `check` proves a path file. `error` and `arguments` stand at the border.

mod arguments;
pub mod check;
pub mod error;
pub mod path;
pub mod scene;
pub mod solve;
