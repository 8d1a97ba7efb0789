//! TODO(page): what lies in scene/sources.

pub(crate) mod follower_limits;
pub(crate) mod package;
pub(crate) mod source;
