//! What a check says and how much it may do; every other module of the checker writes here.
//!
//! `check_report` collects violations of each `kind`. `error` is for files that cannot be checked, with the options of a
//! check; `work` counts what is left of its limits.

pub(crate) mod check_report;
pub mod error;
pub(crate) mod kind;
pub(crate) mod work;

pub use crate::check::report::check_report::{CheckReport, Counts, Extreme, LeftOut, Violation};
pub use crate::check::report::kind::Kind;
