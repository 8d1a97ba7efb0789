//! TODO(page): what lies in check/report.

pub(crate) mod check_report;
pub mod error;
pub(crate) mod kind;
pub(crate) mod work;

pub use crate::check::report::check_report::{CheckReport, Counts, Extreme, LeftOut, Violation};
pub use crate::check::report::kind::Kind;
