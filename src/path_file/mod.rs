//! Path files: `"format": "foliate.path/2"`, the contract that other people's checkers read.
//!
//! The models and this file are all that is needed to play a path back or to prove it again. Numbers are written so that
//! they read back bit for bit; a file holds neither clock times nor thread counts, so that it does not depend on them.
//!
//! Files of version 1, which have no velocities, are read as before.
//!
//! `document` is the form of a file, with the constraints of `constraint`; `version` knows what version 2 added. `write` makes one
//! of a path, with what `timing` says of its times (`names` says how held things are called); `read` reads one (`place` says where a JSON error is), `save` puts one on disk
//! with the models that it names. `loaded_path` makes a path of a file again, on the robot of its models; `export` writes it for other programs.

pub mod constraint;
pub mod document;
pub mod error;
#[cfg(feature = "export")]
pub mod export;
pub mod loaded_path;
pub(crate) mod names;
pub(crate) mod place;
pub(crate) mod read;
pub mod save;
pub(crate) mod timing;
pub(crate) mod version;
pub(crate) mod write;

pub use crate::path_file::constraint::{Bound, ConstraintEntry, FrameEntry, PlaneEntry, PoseRow};
pub use crate::path_file::document::{
    AttachmentEntry, CertificateEntry, Documents, EventEntry, FORMAT, FORMAT_1, GripperEntry, HandleEntry, PairsEntry,
    PartEntry, PathFile, RateLimitEntry, SceneFileEntry, SegmentEntry, SurfaceEntry,
};
pub use crate::path_file::error::PathFileError;
pub use crate::path_file::loaded_path::{LoadPathError, LoadedPath, PartModel};
pub use crate::path_file::write::{FileNames, PartFiles, PathContext, write_path};
