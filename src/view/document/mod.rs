//! The document of a page: what the program writes as JSON and the page reads. `viewer/src` has the other side.
//!
//! Lengths are metres, angles radians, times seconds. A pose `a_from_b` is `[x, y, z, qx, qy, qz, qw]`. z points up. Things refer to each other
//! by their numbers in the lists, from 0. Large arrays lie in a binary blob beside the document: little-endian, each at a
//! multiple of four bytes, by the offset of their first byte.
//!
//! `page` is the whole, `model` the kinematic tree and what it looks like, `graph` the constraint graph with its layout, `path` a motion over
//! time, `finding` what is wrong at a configuration, `search` what a search did.

pub(crate) mod finding;
pub(crate) mod graph;
pub(crate) mod model;
pub(crate) mod page;
pub(crate) mod path;
pub(crate) mod search;

/// A pose: translation, then the quaternion with its real part last.
pub type PoseRow = [f64; 7];
/// The first byte of an array in the blob.
pub type Offset = usize;
