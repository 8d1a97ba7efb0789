//! Which leaves are worth extending, and what to aim at from them.

pub mod aiming;
pub mod grasp_distance;
mod near_draw;
mod state_pair;
mod weighted_leaves;
