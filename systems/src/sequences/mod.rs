//! What the scheduler `sequence` adds to the shared systems: certified short motions between two leaves, planted without the
//! long motions that lead there, and joined on their leaves only where they make up a sequence from start to goal.

pub mod joining;
pub mod leaf_graph;
pub mod planting;
pub mod rounds;
pub mod turns;
