//! TODO(page): what lies in check/world.

pub(crate) mod attachments;
pub(crate) mod documents;
pub(crate) mod models;
