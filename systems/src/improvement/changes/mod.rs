//! Changes of a path that are tried: each answers with motions in place of some of the path's, certified and cheaper, or with nothing.
//!
//! `local_change` names those that need no search: `shortcut` goes straight between two points of a motion, `limb_shortcut` with some
//! coordinates alone (`limbs`), `waypoint_move` moves the waypoints of a grasp change (`waypoint_chain`), `leaf_move` those at both ends of a
//! leaf, and the leaf with them. `replan` searches again between the ends of a stretch. All read a `context`.

pub(crate) mod changed;
pub(crate) mod context;
pub(crate) mod leaf_move;
pub(crate) mod limb_shortcut;
pub mod limbs;
pub mod local_change;
pub(crate) mod replan;
pub(crate) mod shortcut;
pub(crate) mod waypoint_chain;
pub(crate) mod waypoint_move;
