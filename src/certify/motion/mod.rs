//! Motions as the certifier reads them. `piecewise` makes a motion of points, joined as `how` says, in pieces that are
//! `polynomial`s (quaternions of which are `scaled`); `names` finds the links, parts and joints that people name.

pub(crate) mod how;
pub(crate) mod names;
pub(crate) mod piecewise;
pub(crate) mod polynomial;
pub(crate) mod scaled;
