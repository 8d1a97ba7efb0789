//! Which leaves are worth extending, and which leaf to aim at from them.
//!
//! `grasp_distance` estimates how many grasps lie between two leaves, by the tables of `leaf_distance_table`.
//! `leaf_heuristic` keeps that distance for all leaves that were reached; it draws by `weighted_leaves` and
//! `weighted_sampling`. `systems` runs it in a step. `placements` says where objects may be put down on the
//! way, `blocking` what has to move first, which `leaf_detours` adds to distances. A `corridor` keeps a search to few changes of grasp.

pub mod blocking;
pub(crate) mod corridor;
pub mod grasp_distance;
pub(crate) mod leaf_detours;
pub(crate) mod leaf_distance_table;
pub mod leaf_heuristic;
pub(crate) mod measured_leaves;
pub(crate) mod pair_tables;
pub mod placements;
pub mod systems;
pub(crate) mod weighted_leaves;
pub(crate) mod weighted_sampling;
