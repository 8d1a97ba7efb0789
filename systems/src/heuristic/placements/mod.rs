//! Placements that no tree has reached and that may help on the way: where an object can be put down by one grasp and taken away by
//! another.
//!
//! Most problems need none. Where an object cannot be carried from the start to the goal in one hold (a wall with a hole that the
//! hand does not pass, say), the placements between are few, and a search that draws all placements alike hardly meets one. What
//! is missing is found in a relaxed problem: a hand without an arm, and one object among what is fixed in the world.
//!
//! `floating_hand` tests the hand at a grasp, and carries the object straight from one placement to another. `drawing` draws
//! placements of an object. `pool` keeps those that can be reached from the start and from the goal in the relaxed problem, and
//! those that the problem suggests. `systems` grows the pool by counted work while a search goes on, and aims candidates
//! at it. All that the relaxed problem says is a preference: candidates go through every check as usual.

pub(crate) mod drawing;
pub(crate) mod floating_hand;
pub(crate) mod pool;
pub mod systems;

pub use crate::heuristic::placements::drawing::draw_place;
pub use crate::heuristic::placements::pool::PlacementPool;
