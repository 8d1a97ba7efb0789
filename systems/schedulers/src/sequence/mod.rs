//! What the scheduler `sequence` adds to the shared systems: lazy extensions, which are short motions between two leaves without the
//! long motions that lead there. They are joined on their leaves only where they make up a sequence from start to goal.

pub mod candidate_roles;
mod cheapest_way;
pub mod connect_iterations;
pub mod foundations;
pub mod joining;
pub mod lazy_extension;
pub mod leaf_graph;
pub mod local_plans;
pub mod scheduler;

pub use crate::sequence::scheduler::Sequence;
