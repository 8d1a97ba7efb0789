//! TODO(page): what lies in scene/reading.

pub(crate) mod cache_folders;
pub(crate) mod error;
pub(crate) mod input;
pub(crate) mod keys;
pub(crate) mod limits;
pub(crate) mod xml;
