//! Discrete collision checking: verdicts of single configurations.
//!
//! `one` checks one configuration, given the poses of its bodies, by exact queries on each pair. `many` checks up to sixteen
//! configurations at a time: it runs the broad phase first and asks exact queries only for the pairs that stay open. `many`
//! gives the verdicts of `one`, but may name another of several colliding pairs. `along_motion` finds the first of the samples of a motion that
//! collides: it tests the pairs first that collided last.

pub mod along_motion;
pub(crate) mod many;
pub mod one;
