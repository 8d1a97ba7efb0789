//! TODO(page): what lies in certify/formats.

pub(crate) mod csv;
pub(crate) mod numpy;
pub(crate) mod ompl;
pub(crate) mod own;
pub mod read;
pub(crate) mod ros;
pub mod table;

pub use crate::certify::formats::read::{Format, ReadOptions, read, read_bytes};
pub use crate::certify::formats::table::CAP;
