//! TODO(page): what lies in scene/assemble/names.

pub(crate) mod configuration;
pub(crate) mod frame;
pub(crate) mod locked;
