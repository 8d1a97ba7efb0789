//! The parts of a compiled constraint program, in scalar code.
//!
//! `merge` joins a constraint and its complement before compilation. `rigid_attachment` describes an eliminated object and what
//! it follows. `bodies` computes forward kinematics of the bodies that a program needs. `blocks` evaluates the rows of each
//! remaining constraint at their poses. `coordinates` changes configurations: steps, locked values, eliminated objects. The
//! files do not depend on each other. The folder `program` assembles them, `lane_rows` translates them into lanes, and `newton`
//! evaluates them.

pub(crate) mod blocks;
pub(crate) mod bodies;
pub(crate) mod coordinates;
pub(crate) mod merge;
pub(crate) mod rigid_attachment;
