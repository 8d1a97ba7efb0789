//! TODO(page): what lies in cli.

pub(crate) mod command_line;
pub(crate) mod commands;
pub(crate) mod console;
