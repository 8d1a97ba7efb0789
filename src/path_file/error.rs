//! The error of reading and saving path files.

use std::path::PathBuf;

/// Why a path file was not written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum PathFileError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{}: {place}: {source}", path.display())]
    Json { path: PathBuf, place: String, source: serde_json::Error },
    #[error("{}: `format` is `{found}`; this version reads `{}`", path.display(), crate::path_file::document::FORMAT)]
    Format { path: PathBuf, found: String },
}
