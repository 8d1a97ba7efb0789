//! TODO(page): what lies in check.

pub(crate) mod clearance;
pub(crate) mod contract;
pub(crate) mod distance;
pub(crate) mod leaf;
pub(crate) mod limits;
pub(crate) mod motion;
pub mod prove;
pub mod report;
pub(crate) mod structure;
pub(crate) mod world;

pub use crate::check::prove::{check, check_problem};
pub use crate::check::report::check_report::{CheckReport, Counts, Extreme, LeftOut, Violation};
pub use crate::check::report::error::{CheckError, CheckOptions, SceneChoice};
pub use crate::check::report::kind::{Kind, Section, Verdict};
