//! TODO(page): what lies in cli/commands/models.

pub(crate) mod install;
pub(crate) mod unpack;
