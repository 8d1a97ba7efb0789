//! TODO(page): what lies in scene/urdf.

pub(crate) mod attributes;
pub(crate) mod joints;
pub(crate) mod read;
pub(crate) mod tree;
pub(crate) mod values;
