//! Trajectories for other programs: messages of ROS, tables, recordings, animated scenes.
//!
//! `options` says what is asked, `columns` which numbers of the robots that means. `messages` is a tree of values that can be written as JSON
//! and as YAML. `ros`, `csv`, `npz`, `mcap` and `gltf` are the formats, `file` writes one of them for a path file.

pub(crate) mod columns;
pub(crate) mod csv;
pub(crate) mod file;
pub(crate) mod gltf;
pub(crate) mod mcap;
pub(crate) mod messages;
pub(crate) mod npz;
pub(crate) mod options;
pub(crate) mod ros;
pub(crate) mod times;

pub use crate::path_file::export::csv::{csv, csv_of_knots};
pub use crate::path_file::export::file::{Exported, export};
pub use crate::path_file::export::gltf::scene::glb;
pub use crate::path_file::export::mcap::mcap;
pub use crate::path_file::export::npz::npz;
pub use crate::path_file::export::options::{ExportError, ExportOptions, Format};
pub use crate::path_file::export::ros::{ros_json, ros_yaml};
pub use crate::scene::visuals::{Visual, Visuals};
