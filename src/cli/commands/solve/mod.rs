//! `foliate solve`: plan for a scene, say what was found, write the path.
//!
//! `run` is the command. `arguments` are the options of every command that searches, `answer` is what a
//! solve has answered, `record` writes what the search did. `summary` tells people what was found,
//! with `story` for the path and `no_path` where there is none; `summary_json` tells machines. Both report untested pairs by `coverage`.

pub(crate) mod answer;
pub(crate) mod arguments;
pub(crate) mod coverage;
pub(crate) mod no_path;
pub(crate) mod record;
pub(crate) mod run;
pub(crate) mod story;
pub(crate) mod summary;
pub(crate) mod summary_json;
