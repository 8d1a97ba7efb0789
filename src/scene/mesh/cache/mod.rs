//! TODO(page): what lies in scene/mesh/cache.

pub(crate) mod directory;
pub(crate) mod entry;
pub(crate) mod key;
pub(crate) mod mesh_cache;
