//! TODO(page): what lies in check/motion.

pub(crate) mod reach;
pub(crate) mod residual;
pub(crate) mod segment;
