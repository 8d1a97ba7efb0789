//! TODO(page): what lies in scene/mesh.

pub(crate) mod cache;
pub(crate) mod formats;
pub(crate) mod meshes;
