//! Animated scenes in the form glTF 2.0, binary (GLB).
//!
//! `surface` turns solids into triangles, `buffer` collects numbers for the binary chunk, `scene` builds nodes
//! and the animation.

pub(crate) mod buffer;
pub(crate) mod scene;
pub(crate) mod surface;
