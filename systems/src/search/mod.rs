//! One search from start to answer: a world, a schedule that a scheduler fills, and the loop that steps it.
//!
//! `session` is what a host embeds. It makes its world by `world`, asks a `scheduler` for the systems, and takes the path
//! out of the roadmap by `path_extraction`, which measures it by `path_clearance`.

pub mod curve_certificate;
pub mod path_clearance;
pub mod path_extraction;
pub mod scheduler;
pub mod session;
pub(crate) mod world;

pub use crate::search::session::{AnswerIn, Search};
