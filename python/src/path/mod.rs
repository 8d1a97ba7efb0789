//! Paths: `py_path` answers what a robot program or a notebook asks, `segment` and `event` are its parts.

pub(crate) mod event;
pub(crate) mod py_path;
pub(crate) mod segment;
