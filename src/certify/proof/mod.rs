//! How a motion is proved free, or the first contact found.
//!
//! `chords` certifies the chords of a motion in lanes, with margins that cover how far they are off the curve. Where that
//! fails `advance` measures on the curve itself. `contact` measures the contact that was found, and how deep it goes.
//! `nearest` searches for the least clearance of a motion that is free.

pub(crate) mod advance;
pub(crate) mod chords;
pub(crate) mod contact;
pub(crate) mod nearest;
