//! TODO(page): what lies in cli/commands/certify.

pub(crate) mod arguments;
pub(crate) mod run;
pub(crate) mod text;
