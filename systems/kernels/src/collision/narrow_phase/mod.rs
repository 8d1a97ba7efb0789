//! TODO(page): what lies in collision/narrow_phase.

pub(crate) mod pair_at_sample;
pub(crate) mod rigid_pairs;
pub(crate) mod scratch;
pub mod settings;
