//! What stands in the way of what: where many objects change places, this orders the moves.
//!
//! Object a waits for object b where a's target placement and b's present one exclude each other. What waits for nothing can go at
//! once; of what is on a cycle something has to be set aside. (Dependency graphs of object rearrangement: Han et al., *Complexity results
//! and fast methods for optimal tabletop rearrangement with overhand grasps*, IJRR 2018; Krontiris and Bekris, *Dealing with difficult
//! instances of object rearrangement*, RSS 2015.)
//!
//! `exclusions` tests placements against each other and keeps the verdicts. `dependencies` is the graph and says what to set aside. `reach` remembers which grasps
//! were found at which placements. `order` weighs
//! moves by both, `moves` does so for transitions and says what a leaf's distance to another lacks. `buffers` draws placements to set objects aside at; `systems`
//! aims candidates at them. All of it is a preference: candidates go through every check as usual. Problems in which few objects
//! move do without.

pub(crate) mod buffers;
pub(crate) mod dependencies;
pub(crate) mod exclusions;
pub mod moves;
pub(crate) mod order;
pub(crate) mod reach;
pub mod systems;

pub use crate::heuristic::blocking::moves::MoveOrder;
