//! TODO(page): what lies in exploration.

pub mod edges;
pub mod entities;
pub mod explored;
pub mod memory;
pub mod neighbours;
pub mod parameter_column;
pub mod reached_leaves;
pub mod roots;
pub(crate) mod visited_leaves;
pub mod writer;
