//! TODO(page): what lies in scene/srdf.

pub(crate) mod contact;
pub(crate) mod disabled;
pub(crate) mod frames;
pub(crate) mod read;
pub(crate) mod reader;
pub(crate) mod states;
