//! Which leaves are worth extending, and what to aim at from them.

pub mod aiming;
pub mod grasp_distance;
mod weighted_leaves;
