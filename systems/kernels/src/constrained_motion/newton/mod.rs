//! TODO(page): what lies in constrained_motion/newton.

pub(crate) mod batch;
pub(crate) mod lane_values;
pub(crate) mod lanes;
pub(crate) mod scalar;
pub(crate) mod seeds;
pub(crate) mod settings;
