//! The search schedulers that ship: compositions of the systems of `foliate_systems` over one schedule.
//!
//! `mrrt` composes the shared systems. `sequence` adds systems of its own and falls back on `mrrt` where a graph has loops
//! only. `portfolio` runs searches of both. `shipped` lists them by name.
//!
//! The crate is apart from `foliate_systems`, so that the compiler shows that a scheduler needs public items alone: a host's own
//! is written the same way.
#![forbid(unsafe_code)]
#![allow(non_snake_case, reason = "pose names carry their frames")]

pub mod mrrt;
pub mod portfolio;
pub mod sequence;
pub mod shipped;

pub use crate::shipped::{DEFAULT, default_scheduler, named, shipped};
pub use foliate_systems::search::scheduler::Scheduler;
