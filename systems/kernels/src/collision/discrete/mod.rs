//! TODO(page): what lies in collision/discrete.

pub(crate) mod many;
pub mod one;
