//! One search from start to answer: a world, a schedule that a scheduler fills, and the loop that steps it.
//!
//! `session` is what a host embeds. It makes its world by `world`, asks a `scheduler` for the systems, and takes the path
//! out of the roadmap by `path_extraction`, once `excursions` has left out what is needless and stretches with needless `regrasps` are
//! planned again; `path_clearance` measures it.
//! `timed_certificate` proves a path with times;
//! `segment_leaf` reads the leaf of a segment from the path, `timed_rows` its curve.

pub(crate) mod excursions;
pub mod path_clearance;
pub mod path_extraction;
pub(crate) mod regrasps;
pub mod scheduler;
pub(crate) mod segment_leaf;
pub mod session;
pub mod timed_certificate;
pub mod timed_rows;
pub(crate) mod world;

pub use crate::search::session::{AnswerIn, PlanAgain, Search};
