//! TODO(page): what lies in search.

pub mod path_clearance;
pub mod path_extraction;
pub mod scheduler;
pub mod session;
pub(crate) mod world;

pub use crate::search::session::{AnswerIn, Search};
