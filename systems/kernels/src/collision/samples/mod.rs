//! TODO(page): what lies in collision/samples.

pub(crate) mod interval;
pub mod motion_bound;
pub(crate) mod motion_samples;
pub(crate) mod place_bodies;
