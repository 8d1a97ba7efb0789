//! The error of a batch, and the one way in which its files are written whole.

use crate::batch::results::csv::csv_line;
use crate::batch::results::row::{COLUMNS, Row};
use crate::os::output;
use crate::scene::reading::error::SceneError;
use std::path::{Path, PathBuf};

/// Most solves of a batch.
pub(crate) const MOST_SOLVES: u64 = 1_000_000;

/// Why a batch does not start, or stops.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum BatchError {
    #[error("a batch needs at least one scene")]
    Empty,
    #[error("two scenes are called `{0}`: their rows and paths could not be told apart")]
    SameName(String),
    #[error("a batch needs at least one scheduler")]
    NoScheduler,
    #[error("there is no scheduler `{0}`")]
    UnknownScheduler(String),
    #[error("scheduler `{0}` is given twice")]
    SameScheduler(String),
    #[error("a batch needs at least one group of settings")]
    NoSettings,
    #[error("two groups of settings are called `{0}`: their rows could not be told apart")]
    SameSettings(String),
    #[error("the settings `{0}` and `{1}` are the same: their rows would be, too")]
    EqualSettings(String, String),
    #[error(
        "the settings `{name}` use {threads} threads, and the batch has {all}; give it as many (--threads {threads})"
    )]
    Oversubscribed { name: String, threads: usize, all: usize },
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("{0} solves are more than the {MOST_SOLVES} of one batch; split the seeds")]
    TooMany(u64),
    #[error("{} is there already; choose another folder, go on with it (resume), or remove it", path.display())]
    Exists { path: PathBuf },
    #[error("{}: another process is writing it", path.display())]
    Busy { path: PathBuf },
    #[error("{}: its results were made with {what} = {was}, now it is {is}; rows of two settings do not go together", path.display())]
    Different { path: PathBuf, what: String, was: String, is: String },
    #[error("{}: has a row of scene `{}`, seed {seed}, which this batch does not solve", path.display(), scene.escape_debug())]
    Foreign { path: PathBuf, scene: String, seed: u64 },
    #[error("{}:{line}: {what}", path.display())]
    Damaged { path: PathBuf, line: usize, what: String },
    #[error("a plot cannot be drawn: {0}")]
    Plot(String),
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
}

/// `results.csv` with some rows.
pub(crate) fn text<'a>(rows: impl IntoIterator<Item = &'a Row>) -> String {
    rows.into_iter().fold(csv_line(&COLUMNS), |text, row| text + &row.csv())
}

/// Writes a file: there is never half of one.
pub(crate) fn write_whole(path: &Path, text: &str) -> Result<(), BatchError> {
    output::write(path, text.as_bytes()).map_err(|source| BatchError::Io { path: path.to_owned(), source })
}
