//! TODO(page): what lies in collision/broad_phase.

pub(crate) mod along;
pub(crate) mod block_of_samples;
pub(crate) mod bounds;
pub(crate) mod open_pairs;
pub(crate) mod placed;
