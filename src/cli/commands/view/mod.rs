//! `foliate view`: `run` makes the page of a path, a scene or a model, `answered` that of a solve, `written` puts it on disk.

pub(crate) mod answered;
pub(crate) mod run;
pub(crate) mod written;
