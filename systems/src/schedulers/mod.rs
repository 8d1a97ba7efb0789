//! Search schedulers: compositions of systems over one schedule. A host's own is written the same way.
//!
//! `mrrt` composes the shared systems of `crate::step`. `sequence` adds systems of its own and falls back on `mrrt` where a
//! graph has loops only. `portfolio` runs searches of both. `shipped` lists them by name. The trait [`Scheduler`] is in
//! `crate::search::scheduler`, since a search needs it and no scheduler.

pub mod mrrt;
pub mod portfolio;
pub mod sequence;
pub mod shipped;

pub use crate::schedulers::shipped::{DEFAULT, default_scheduler, named, shipped};
pub use crate::search::scheduler::Scheduler;
