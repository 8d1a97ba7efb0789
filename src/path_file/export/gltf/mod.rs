//! Animated scenes in the form glTF 2.0, binary (GLB).
//!
//! `visuals` is what links look like, `surface` turns solids into triangles, `buffer` collects numbers for the binary chunk, `scene` builds nodes
//! and the animation.

pub(crate) mod buffer;
pub(crate) mod scene;
pub(crate) mod surface;
pub(crate) mod visuals;
