//! What a scene file names in a robot: coordinates (`configuration`), joints that never move (`locked`), frames and links
//! (`frame`).

pub(crate) mod configuration;
pub(crate) mod frame;
pub(crate) mod locked;
pub(crate) mod start_file;
