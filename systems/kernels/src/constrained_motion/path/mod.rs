//! TODO(page): what lies in constrained_motion/path.

pub(crate) mod constrained_path;
pub(crate) mod lane_motion;
pub(crate) mod motion;
pub(crate) mod settings;
