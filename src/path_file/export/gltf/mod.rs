//! Animated scenes in the form glTF 2.0, binary (GLB).
//!
//! `buffer` collects numbers for the binary chunk, `scene` builds nodes
//! and the animation.

pub(crate) mod buffer;
pub(crate) mod scene;
