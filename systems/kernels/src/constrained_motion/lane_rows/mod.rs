//! TODO(page): what lies in constrained_motion/lane_rows.

pub(crate) mod balance;
pub(crate) mod building;
pub(crate) mod form;
pub(crate) mod hand;
pub(crate) mod linearise;
pub(crate) mod memory;
pub(crate) mod slots;
