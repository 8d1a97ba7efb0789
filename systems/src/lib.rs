//! The verbs of Foliate: systems over the nouns of `foliate_components`, with the numbers of `foliate_kernels`.
//!
//! [`graph`] makes the constraint graph of a problem, [`constraint_programs`] compiles what it demands,
//! [`model`] holds both with the other tables. A search ([`search`]) is a world whose [`schedule`] runs the sets of
//! [`schedule::SearchSet`] step after step; [`schedulers`] are the compositions that ship.
#![forbid(unsafe_code)]
// Frames stand in names as the field writes them: `X_WG` is the pose of G in W, so that `X_WG * X_GH` reads right.
#![allow(non_snake_case, reason = "pose names carry their frames")]

pub mod column;
pub mod commit;
pub mod conclusion;
pub mod connection;
pub mod constraint_programs;
pub mod demands;
pub mod errands;
pub mod events;
pub mod feedback;
pub mod foreseen;
pub mod goals;
pub mod graph;
pub mod guidance;
pub mod in_order;
pub mod membership;
pub mod memory;
pub mod model;
pub mod neighbours;
mod parallel;
pub mod passages;
pub mod path_clearance;
pub mod path_extraction;
pub mod projection;
pub mod random;
pub mod reached_leaves;
pub mod rendezvous;
pub mod sampling;
pub mod schedule;
pub mod schedulers;
pub mod scratch_pool;
pub mod search;
pub mod selection;
pub mod sequences;
pub mod settings;
pub mod steering;
pub mod validation;
mod visited_leaves;
pub mod waypoints;
pub mod worlds;
