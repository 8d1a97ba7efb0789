//! TODO(page): what lies in constrained_motion/rows.

pub(crate) mod blocks;
pub(crate) mod bodies;
pub(crate) mod coordinates;
pub(crate) mod merge;
pub(crate) mod rigid_attachment;
