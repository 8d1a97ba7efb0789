//! TODO(page): what lies in exploration/neighbours.

pub mod index;
pub(crate) mod nearest_of_each;
pub(crate) mod other_trees;

pub use crate::exploration::neighbours::index::Neighbours;
pub use crate::exploration::neighbours::nearest_of_each::{Question, Region};
