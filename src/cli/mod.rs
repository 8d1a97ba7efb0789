//! The command-line program. `command_line` parses the arguments and runs one of the `commands`; all commands print and stop
//! by means of `console`.
//!
//! Exit codes: 0 done, 1 no solution or a check that fails, 2 wrong usage or input, or output that could not be written, 3
//! proved only relative to what a file says of itself, 4 undecided within limits, 130 interrupted.

pub(crate) mod command_line;
pub(crate) mod commands;
pub(crate) mod console;

pub use crate::cli::command_line::run_program;
