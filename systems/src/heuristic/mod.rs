//! Which leaves are worth extending, and what to aim at from them.

pub mod grasp_distance;
pub(crate) mod leaf_distance_table;
pub mod leaf_heuristic;
pub mod systems;
pub(crate) mod weighted_leaves;
pub(crate) mod weighted_sampling;
