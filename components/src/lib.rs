//! The nouns of Foliate: plain data with invariants, no search.
//!
//! A [`robot::Robot`] is the *hybrid robot* of the papers (P0 §II-A): robots, objects and environment as one kinematic
//! tree. [`graph`] holds states and transitions, [`leaf`](crate::graph::leaf) the leaves of their foliations, [`roadmap`] what a search has
//! reached, [`path`] what it answers.
//!
//! Units are SI and radians, world z points up, quaternions are stored x y z w. `X_AB` and `a_from_b` both name the pose of
//! frame B in frame A, so that products read by adjacency.
#![forbid(unsafe_code)]

pub mod candidate;
pub mod constraint;
pub mod coverage;
pub mod graph;
pub mod infeasibility;
pub mod outcome;
pub mod path;
pub mod pose;
pub mod problem;
pub mod roadmap;
pub mod robot;
pub mod samples;

pub use crate::pose::Pose;
