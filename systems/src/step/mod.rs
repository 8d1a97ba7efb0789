//! The systems of a step, set by set: one file or folder each, named after what it does.
//!
//! A candidate passes `sampling`, `selection`, `rendezvous`, `projection`, `waypoints`, `steering` and `validation`;
//! `lazy_extension` leaves out and drops what a lazy scheduler does not need.
//! `commit` adds what is certified to the roadmap. Then `connection` tries new nodes against other trees, `local_planner` plans what a
//! straight motion does not join, and `conclusion` asks whether the search is over. `crate::schedule` gives the order of the sets; schedulers put the systems into them.

pub mod commit;
pub mod conclusion;
pub mod connection;
pub mod lazy_extension;
pub mod local_planner;
pub mod projection;
pub mod rendezvous;
pub mod sampling;
pub mod selection;
pub mod steering;
pub mod validation;
pub mod waypoints;
