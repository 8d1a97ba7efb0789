//! Set Project: the waypoints of each candidate, leg by leg (P1 Alg. 2 lines 2-6, with P0's waypoints).
//!
//! Candidates that try the same transition share its constraint programs, so they are projected side by side, one per lane.
//! Right-hand sides (where the near node's leaf has the objects, which leaf was drawn) are arguments of the solve. `project`
//! is the system; `arriving` says on which leaf a leg ends.

pub(crate) mod arriving;
pub mod project;
