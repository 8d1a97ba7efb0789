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
    #[error(
        "{}: `format` is `{found}`; this version reads `{}` and `{}`",
        path.display(), crate::path_file::document::FORMAT, crate::path_file::document::FORMAT_1
    )]
    Format { path: PathBuf, found: String },
    #[error(
        "{}: {key}: this key belongs to `{}`, the file is of `{}`",
        path.display(), crate::path_file::document::FORMAT, crate::path_file::document::FORMAT_1
    )]
    Version { path: PathBuf, key: String },
}
