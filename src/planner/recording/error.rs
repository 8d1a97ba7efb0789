//! The error of reading and writing recordings.

use crate::path_file::error::PathFileError;
use std::path::PathBuf;

/// Why a recording was not written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum RecordingError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{}: {place}: {source}", path.display())]
    Json { path: PathBuf, place: String, source: serde_json::Error },
    #[error("{}: `format` is `{found}`; this version reads `{}`", path.display(), crate::planner::recording::document::FORMAT)]
    Format { path: PathBuf, found: String },
    #[error("{}: {place}: {message}", path.display())]
    Malformed { path: PathBuf, place: String, message: String },
    #[error(transparent)]
    Models(#[from] PathFileError),
}
