//! TODO(page): what lies in certify/motion.

pub(crate) mod names;
pub(crate) mod piecewise;
pub(crate) mod polynomial;
