//! TODO(page): what lies in cli/commands/solve.

pub(crate) mod arguments;
pub(crate) mod coverage;
pub(crate) mod run;
pub(crate) mod story;
pub(crate) mod summary;
pub(crate) mod summary_json;
