//! TODO(page): what lies in step/connection.

pub(crate) mod attempt;
pub mod connect;
pub mod speculative_checks;
