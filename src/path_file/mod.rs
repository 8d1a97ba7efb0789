//! TODO(page): what lies in path_file.

pub mod constraint;
pub mod document;
pub mod error;
pub(crate) mod place;
pub(crate) mod read;
pub mod save;
pub(crate) mod write;

pub(crate) use crate::path_file::constraint::entries as constraint_entries;
pub use crate::path_file::constraint::{Bound, ConstraintEntry, FrameEntry, PlaneEntry, PoseRow};
pub use crate::path_file::document::{
    AttachmentEntry, CertificateEntry, Documents, FORMAT, GripperEntry, HandleEntry, PairsEntry, PartEntry, PathFile,
    SceneFileEntry, SegmentEntry, SurfaceEntry,
};
pub use crate::path_file::write::{FileNames, PartFiles, PathContext, write_path};
