//! URDF: one strict pass that knows the line of everything it refuses.
//!
//! Names must exist and be unique, vectors have exactly three finite numbers, the joints make one tree, followers have a
//! leader. Elements for simulation only (`gazebo`, `transmission`) are not read; `visuals` reads what links look like.
//!
//! `read` reads the links and calls `joints`, which `tree` checks. Both read `values`; `range` says what limits mean. `attributes`,
//! `sizes` and `soft_limits` report what a file says and is not read, or cannot be meant. `parsed` takes what the crate `urdf-rs` has read instead.

pub(crate) mod attributes;
pub(crate) mod joints;
#[cfg(feature = "urdf-rs")]
pub(crate) mod parsed;
pub(crate) mod range;
pub(crate) mod read;
pub(crate) mod sizes;
pub(crate) mod soft_limits;
pub(crate) mod tree;
pub(crate) mod values;
#[cfg(feature = "visuals")]
pub(crate) mod visuals;
