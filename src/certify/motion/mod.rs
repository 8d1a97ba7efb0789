//! Motions as the certifier reads them. `piecewise` makes a motion of points, in pieces that are `polynomial`s; `names`
//! finds the links, parts and joints that people name.

pub(crate) mod names;
pub(crate) mod piecewise;
pub(crate) mod polynomial;
