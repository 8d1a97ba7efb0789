//! The verbs of Foliate: systems over the nouns of `foliate_components`, with the numbers of `foliate_kernels`.
//!
//! [`graph_building`] makes the constraint graph of a problem, [`constraint_programs`] compiles what it demands,
//! [`model`] holds both with the other tables. A search ([`search`]) is a world whose [`schedule`] runs the sets of
//! [`schedule::SearchSet`] step after step; [`schedulers`] are the compositions that ship.
#![forbid(unsafe_code)]
// Frames stand in names as the field writes them: `X_WG` is the pose of G in W, so that `X_WG * X_GH` reads right.
#![allow(non_snake_case, reason = "pose names carry their frames")]

pub mod aiming;
pub mod carriers;
pub mod commit;
pub mod conclusion;
pub mod connection;
pub mod constraint_programs;
pub mod demands;
pub mod events;
pub mod feedback;
pub(crate) mod goal_programs;
pub mod goals;
pub mod graph_building;
mod graph_cases;
mod graph_growth;
pub mod grasp_distance;
pub mod membership;
pub mod model;
pub mod path_extraction;
pub mod projection;
pub mod random;
pub mod rendezvous;
pub mod resting;
pub mod sampling;
pub mod schedule;
pub mod schedulers;
pub mod search;
pub mod selection;
pub mod settings;
pub mod steering;
pub mod validation;
