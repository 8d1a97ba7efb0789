//! What an earlier run of a batch has left.

use crate::batch::error::BatchError;
use crate::batch::results::csv::records;
use crate::batch::results::row::{COLUMNS, Row, RowOutcome};
use std::path::Path;

/// Largest `results.csv` or `settings.json` that is read, bytes: a million rows.
const CAP: u64 = 1 << 30;

/// The text of a file of a batch.
pub(crate) fn read_text(path: &Path) -> Result<String, BatchError> {
    let failed = |source| BatchError::Io { path: path.to_owned(), source };
    let found = std::fs::metadata(path).map_err(failed)?;
    if !found.is_file() || found.len() > CAP {
        return Err(failed(std::io::Error::other("is no regular file of at most 1 GiB")));
    }
    let bytes = std::fs::read(path).map_err(failed)?;
    // The last line may have been cut anywhere.
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The whole rows of a `results.csv`.
pub(crate) fn read(path: &Path) -> Result<Vec<Row>, BatchError> {
    let row = |(line, cells): (usize, Vec<String>)| {
        let damaged = || BatchError::Damaged { path: path.to_owned(), line, what: "is no row".into() };
        Row::of_cells(&cells).ok_or_else(damaged)
    };
    table(path, &COLUMNS)?.into_iter().map(row).collect()
}

/// The whole rows of a table with these columns, and the line in which each begins. What stands behind the last line break is
/// dropped: its line was not finished.
pub(crate) fn table(path: &Path, columns: &[&str]) -> Result<Vec<(usize, Vec<String>)>, BatchError> {
    let mut rows = records(&read_text(path)?);
    match rows.first() {
        None => return Ok(rows),
        Some((_, head)) if head == columns => {}
        Some(_) => {
            let what = "has other columns".into();
            return Err(BatchError::Damaged { path: path.to_owned(), line: 1, what });
        }
    }
    rows.remove(0);
    Ok(rows)
}

/// Whether a solve ended as it would again: a row that could not start, or whose path could not be written, says nothing, and a
/// limit of memory may be another one now.
pub(crate) fn is_final(row: &Row) -> bool {
    ![RowOutcome::Failed, RowOutcome::MemoryLimit].contains(&row.outcome)
}
