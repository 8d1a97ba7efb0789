//! Set Connect: new nodes against nodes on the same leaf in other trees (P1 Alg. 3).
//!
//! P1's line 7 asks whether both configurations lie on one leaf of the transition between them; here that is equality of
//! leaf ids, and the transition is the loop of their state. (Across states Alg. 3 would have to invent waypoints; a crossed
//! extension does that on purpose, with a leaf it has chosen.)
//!
//! `attempt` is one connection: a straight motion, or an unvalidated edge. `connect` proposes connections and certifies them.

pub(crate) mod attempt;
pub mod connect;
