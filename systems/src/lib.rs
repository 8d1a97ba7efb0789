//! The verbs of Foliate: systems over the nouns of `foliate_components`, with the numbers of `foliate_kernels`.
//!
//! [`planning_model`] makes the constraint graph of a problem, compiles its constraints, and holds both with the other
//! tables. A search ([`search`]) is a world whose [`schedule`] runs the sets of [`schedule::SearchSet`] step after step; the
//! systems of these sets are in [`step`], what they have reached in [`exploration`]. [`goals`] draws configurations of goals,
//! [`heuristic`] tells which leaves are worth extending, and where to put objects down on the way. The crate
//! `foliate_schedulers` composes them. [`runtime`] shares work
//! among threads.
#![forbid(unsafe_code)]
// Frames stand in names as the field writes them: `X_WG` is the pose of G in W, so that `X_WG * X_GH` reads right.
#![allow(non_snake_case, reason = "pose names carry their frames")]

pub mod events;
pub mod exploration;
pub mod goals;
pub mod heuristic;
pub mod improvement;
pub mod planning_model;
pub mod runtime;
pub mod schedule;
pub mod search;
pub mod settings;
pub mod step;
pub mod trajectory;
