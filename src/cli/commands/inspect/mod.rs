//! `foliate inspect`: `run` prints what was read from a model, `found` what a setup finds in it.

mod found;
pub(crate) mod run;
