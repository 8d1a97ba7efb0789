//! Collision along a segment. `pairs` lists what is tested, without the neighbours that `adjacent` finds. `along` proves
//! each pair free over the continuum, with `enclosure` for solids inside closed meshes. `certificate` compares the result
//! with what the file claims.

pub(crate) mod adjacent;
pub(crate) mod along;
pub(crate) mod certificate;
pub(crate) mod enclosure;
pub(crate) mod pairs;
