//! The files of a batch.

use super::BatchError;
use super::row::{COLUMNS, Row, csv_line};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes rows as they come.
pub(super) struct Recorder {
    path: PathBuf,
    file: File,
    rows: Vec<(usize, Row)>,
}

/// `paths/SCENE-SEED.json`.
pub(super) fn path_file(out: &Path, scene: &str, seed: u64) -> PathBuf {
    out.join("paths").join(format!("{scene}-{seed}.json"))
}

impl Recorder {
    /// Makes the folder and begins `results.csv`, which must not be there yet: the paths beside it belong to its rows.
    pub(super) fn create(out: &Path) -> Result<Self, BatchError> {
        let folder = out.join("paths");
        std::fs::create_dir_all(&folder).map_err(|source| BatchError::Io { path: folder.clone(), source })?;
        let path = out.join("results.csv");
        let file = File::create_new(&path).map_err(|source| match source.kind() {
            std::io::ErrorKind::AlreadyExists => BatchError::Exists { path: path.clone() },
            _ => BatchError::Io { path: path.clone(), source },
        })?;
        let mut recorder = Self { path, file, rows: Vec::new() };
        recorder.append(&csv_line(&COLUMNS))?;
        Ok(recorder)
    }

    /// Adds the row of the solve with that number. It is in the file when this returns.
    pub(super) fn record(&mut self, index: usize, row: &Row) -> Result<(), BatchError> {
        self.append(&row.csv())?;
        self.rows.push((index, row.clone()));
        Ok(())
    }

    fn append(&mut self, line: &str) -> Result<(), BatchError> {
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.flush());
        written.map_err(|source| BatchError::Io { path: self.path.clone(), source })
    }

    /// Puts the rows in order.
    pub(super) fn finish(mut self) -> Result<Vec<Row>, BatchError> {
        self.rows.sort_by_key(|(index, _)| *index);
        let rows: Vec<Row> = self.rows.into_iter().map(|(_, row)| row).collect();
        let mut text = csv_line(&COLUMNS);
        rows.iter().for_each(|row| text.push_str(&row.csv()));
        write_whole(&self.path, &text)?;
        Ok(rows)
    }
}

/// Writes a file: to a temporary name first, so that there is never half of one.
pub(super) fn write_whole(path: &Path, text: &str) -> Result<(), BatchError> {
    let failed = |source| BatchError::Io { path: path.to_owned(), source };
    let part = path.with_extension("part");
    let mut file = File::create(&part).map_err(failed)?;
    file.write_all(text.as_bytes()).and_then(|()| file.sync_all()).map_err(failed)?;
    std::fs::rename(&part, path).map_err(failed)
}
