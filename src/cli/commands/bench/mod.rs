//! `foliate bench`: many seeds of some scenes, or a suite, a row each, and the table of the papers.
//!
//! `run` makes the batch that its `arguments` or a suite file say, shows its `progress`, and prints what `text` makes of the rows.

pub(crate) mod arguments;
pub(crate) mod progress;
pub(crate) mod run;
pub(crate) mod text;
