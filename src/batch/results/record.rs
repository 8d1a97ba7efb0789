//! The files of a batch.

use crate::batch::error::{BatchError, text, write_whole};
use crate::batch::improvement::files::{ImprovementFiles, join};
use crate::batch::results::csv::csv_line;
use crate::batch::results::identity::Identity;
use crate::batch::results::kept;
use crate::batch::results::row::{COLUMNS, Row};
use crate::os::output;
use crate::os::output::Lines;
use std::collections::HashSet;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Recordings of failed solves that a batch writes at most.
pub(crate) const MOST_FAILURES: usize = 100;

/// Where solves are recorded that found no path.
#[derive(Debug)]
pub(crate) struct FailureFolder {
    folder: PathBuf,
    failed: AtomicUsize,
}

impl FailureFolder {
    pub(crate) fn new(folder: PathBuf) -> Self {
        Self { folder, failed: AtomicUsize::new(0) }
    }

    /// Makes the folder, where it is missing.
    pub(crate) fn create(&self) -> Result<(), BatchError> {
        std::fs::create_dir_all(&self.folder).map_err(|source| BatchError::Io { path: self.folder.clone(), source })
    }

    /// Where the next failed solve is recorded; none once there are enough.
    pub(crate) fn next(&self, stem: &str) -> Option<PathBuf> {
        let number = self.failed.fetch_add(1, Ordering::Relaxed);
        (number < MOST_FAILURES).then(|| self.folder.join(format!("{stem}.search")))
    }

    /// Solves that have failed by now.
    pub(crate) fn failed(&self) -> usize {
        self.failed.load(Ordering::Relaxed)
    }
}

/// Writes rows as they come.
pub(crate) struct Recorder {
    path: PathBuf,
    lines: Lines,
    /// What rows have beyond their cells, where the batch improves paths.
    improvement: Option<ImprovementFiles>,
    rows: Vec<(usize, Row)>,
}

/// `paths/STEM.json`.
pub(crate) fn path_file(out: &Path, stem: &str) -> PathBuf {
    out.join("paths").join(format!("{stem}.json"))
}

impl Recorder {
    /// Makes the folder and begins `results.csv`, which must not be there yet: the paths beside it belong to its rows.
    pub(crate) fn create(out: &Path, identity: &Identity, improves: bool) -> Result<Self, BatchError> {
        let folder = out.join("paths");
        std::fs::create_dir_all(&folder).map_err(|source| BatchError::Io { path: folder.clone(), source })?;
        let path = out.join("results.csv");
        let lines = Lines::create_new(&path).map_err(|source| match source.kind() {
            ErrorKind::AlreadyExists => BatchError::Exists { path: path.clone() },
            _ => BatchError::Io { path: path.clone(), source },
        })?;
        let improvement = if improves { Some(ImprovementFiles::begin(out, std::iter::empty())?) } else { None };
        let mut recorder = Self { path, lines, improvement, rows: Vec::new() };
        recorder.append(&csv_line(&COLUMNS))?;
        identity.write(out)?;
        Ok(recorder)
    }

    /// Goes on with the `results.csv` of an earlier run of the same batch: its whole rows stay, but for those that were not
    /// solved to an end. A folder without one is begun.
    pub(crate) fn resume(
        out: &Path,
        identity: &Identity,
        improves: bool,
        index: impl Fn(&Row) -> Option<usize>,
        has_path: impl Fn(&Row) -> bool,
    ) -> Result<Self, BatchError> {
        let path = out.join("results.csv");
        let failed = |source| BatchError::Io { path: path.clone(), source };
        if !path.try_exists().map_err(failed)? {
            return Self::create(out, identity, improves);
        }
        identity.compare(out)?;
        // No other process may append between reading and writing.
        let held = Lines::open(&path).map_err(|source| match source.kind() {
            ErrorKind::WouldBlock => BatchError::Busy { path: path.clone() },
            _ => failed(source),
        })?;
        let rows = kept::read(&path)?;
        let numbered = |row: Row| match index(&row) {
            Some(index) => Ok((index, row)),
            None => Err(BatchError::Foreign { path: path.clone(), scene: row.scene, seed: row.seed }),
        };
        let mut rows = rows.into_iter().map(numbered).collect::<Result<Vec<_>, _>>()?;
        let mut seen = HashSet::new();
        rows.retain(|(index, row)| kept::is_final(row) && has_path(row) && seen.insert(*index));
        let improvement = match improves {
            true => {
                join(out, &mut rows)?;
                Some(ImprovementFiles::begin(out, rows.iter().map(|(_, row)| row))?)
            }
            false => None,
        };
        output::write(&path, text(rows.iter().map(|(_, row)| row)).as_bytes()).map_err(failed)?;
        // The file has been replaced by its whole rows; what was held is gone with the old one.
        let lines = Lines::open(&path).map_err(failed)?;
        drop(held);
        Ok(Self { path, lines, improvement, rows })
    }

    /// The solves that have their row already, by number.
    pub(crate) fn done(&self) -> &[(usize, Row)] {
        &self.rows
    }

    /// Adds the row of the solve with that number. It is in the file when this returns.
    pub(crate) fn record(&mut self, index: usize, row: &Row) -> Result<(), BatchError> {
        if let Some(files) = &mut self.improvement {
            files.append(row)?;
        }
        self.append(&row.csv())?;
        self.rows.push((index, row.clone()));
        Ok(())
    }

    fn append(&mut self, line: &str) -> Result<(), BatchError> {
        self.lines.append(line).map_err(|source| BatchError::Io { path: self.path.clone(), source })
    }

    /// Puts the rows in order.
    pub(crate) fn finish(mut self) -> Result<Vec<Row>, BatchError> {
        self.rows.sort_by_key(|(index, _)| *index);
        let rows: Vec<Row> = self.rows.into_iter().map(|(_, row)| row).collect();
        if let Some(files) = self.improvement {
            files.finish(rows.iter())?;
        }
        write_whole(&self.path, &text(&rows))?;
        Ok(rows)
    }
}
