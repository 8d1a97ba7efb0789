//! A path over time.
//!
//! `sampling` cuts it into samples that may be joined by straight lines, `segments` says in
//! words what happens on each leaf and when hands take and let go, `clearance` how close things come, `refusals` what a check refuses.

pub(crate) mod clearance;
pub(crate) mod refusals;
pub(crate) mod sampling;
pub(crate) mod segments;
