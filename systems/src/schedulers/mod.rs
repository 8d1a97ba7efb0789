//! TODO(page): what lies in schedulers.

pub mod mrrt;
pub mod portfolio;
pub mod sequence;
pub mod shipped;

pub use crate::schedulers::shipped::{DEFAULT, default_scheduler, named, shipped};
pub use crate::search::scheduler::Scheduler;
