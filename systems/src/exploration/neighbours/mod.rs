//! Which nodes are nearest: on a leaf, in a state, of the whole roadmap. Kept by the commit, asked by Select and Connect.
//!
//! Few nodes are measured one by one. Where a leaf has more, their coordinates lie in blocks of lanes too, by the tree in
//! which they were born ([`foliate_kernels::nearest`]); the answer is the same bit for bit. What a step asks of the same
//! nodes is asked together, so that a block is read once for several: `nearest_of_each` is what Select wants, `other_trees`
//! what Connect does. Both read the nodes that `index` keeps. No answer depends on who else asks.

pub mod index;
pub(crate) mod nearest_of_each;
pub(crate) mod other_trees;

pub use crate::exploration::neighbours::index::Neighbours;
pub use crate::exploration::neighbours::nearest_of_each::{Question, Region};
