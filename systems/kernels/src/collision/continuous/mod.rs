//! Continuous collision checking: what holds over whole motions, not only at samples.
//!
//! `adaptive_certifier` proves that all pairs keep their margins, by adaptive subdivision; `subdivision` holds its rules for
//! cutting intervals. `polyline` runs the certifier and gives the verdict on a polyline. `straight` treats a straight motion as
//! a polyline of one piece. `minimum`, with `minimum_settings`, computes the least clearance along a motion by branch and
//! bound; it does not depend on the certifier. `curve` applies both to curves over time. All use the rooms `samples` for motion bounds and `narrow_phase` for buffers.

pub(crate) mod adaptive_certifier;
pub mod curve;
pub mod minimum;
pub mod minimum_settings;
pub mod polyline;
pub mod straight;
pub(crate) mod subdivision;
