//! TODO(page): what lies in step/projection.

pub(crate) mod arriving;
pub mod project;
