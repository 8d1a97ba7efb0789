//! Generated problems of one arm above a table: impossible ones, by what makes them so, and solvable ones.
//!
//! `scene` builds a problem from a few numbers, `impossible` and `solvable` draw them, and `verdict` says what a solve told of one.

pub mod impossible;
pub mod scene;
pub mod solvable;
pub mod verdict;
