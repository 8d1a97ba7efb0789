//! TODO(page): what lies in scene/mesh/formats.

pub(crate) mod dae;
pub(crate) mod dae_values;
pub(crate) mod obj;
pub(crate) mod stl;
pub(crate) mod triangles;
