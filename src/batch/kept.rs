//! What an earlier run of a batch has left, and whether it is the same batch.

use super::entry::Entry;
use super::row::{COLUMNS, Row, RowOutcome};
use crate::batch::error::BatchError;
use foliate_components::problem::Problem;
use foliate_components::robot::shape::Geometry;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// Largest `results.csv` or `settings.json` that is read, bytes: a million rows.
const CAP: u64 = 1 << 30;

/// What decides the rows of a batch, by name: everything but the number of threads. It stands in `settings.json`.
#[derive(Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Identity(pub BTreeMap<String, String>);

impl Identity {
    /// Writes `settings.json`.
    pub(crate) fn write(&self, out: &Path) -> Result<(), BatchError> {
        let path = out.join("settings.json");
        let text = serde_json::to_string_pretty(self)
            .map_err(|e| BatchError::Io { path: path.clone(), source: std::io::Error::other(e) })?;
        crate::batch::error::write_whole(&path, &(text + "\n"))
    }

    /// Whether the results in a folder were made with the same.
    pub(crate) fn compare(&self, out: &Path) -> Result<(), BatchError> {
        let path = out.join("settings.json");
        let text = read_text(&path)?;
        let Self(was) = serde_json::from_str(&text).map_err(|e| BatchError::Damaged {
            path: path.clone(),
            line: e.line(),
            what: e.to_string(),
        })?;
        let names = self.0.keys().chain(was.keys());
        let value =
            |of: &BTreeMap<String, String>, name: &String| of.get(name).cloned().unwrap_or_else(|| "nothing".into());
        match names.clone().find(|name| self.0.get(*name) != was.get(*name)) {
            None => Ok(()),
            Some(name) => Err(BatchError::Different {
                path: out.to_owned(),
                what: name.clone(),
                was: value(&was, name),
                is: value(&self.0, name),
            }),
        }
    }
}

/// Hexadecimal SHA-256 of everything that defines a problem.
pub(crate) fn fingerprint(entry: &Entry) -> String {
    struct Hash(Sha256);
    impl Write for Hash {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            self.0.update(text);
            Ok(())
        }
    }
    let mut hash = Hash(Sha256::new());
    let mut problem: Problem = entry.model().problem.clone();
    // Whether a mesh comes with what was found out about it earlier is no part of the problem.
    for shape in &mut problem.robot.shapes {
        let Geometry::Mesh(mesh) = &shape.geometry else { continue };
        let numbers = mesh.vertices.iter().flat_map(|vertex| vertex.to_array());
        numbers.for_each(|number| hash.0.update(number.to_bits().to_le_bytes()));
        mesh.triangles.iter().flatten().for_each(|index| hash.0.update(index.to_le_bytes()));
        shape.geometry = Geometry::Sphere { radius: 0.0 };
    }
    let _cannot_fail = write!(hash, "{problem:?}");
    hash.0.finalize().iter().fold(String::new(), |mut text, byte| {
        let _cannot_fail = write!(text, "{byte:02x}");
        text
    })
}

fn read_text(path: &Path) -> Result<String, BatchError> {
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

/// The records of a CSV text (RFC 4180) that are whole, with the line in which each begins.
fn records(text: &str) -> Vec<(usize, Vec<String>)> {
    let (mut records, mut cells, mut cell) = (Vec::new(), Vec::new(), String::new());
    let (mut line, mut begins, mut quoted) = (1, 1, false);
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        line += usize::from(character == '\n');
        match character {
            '"' if quoted && characters.peek() == Some(&'"') => cell.extend(characters.next()),
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(std::mem::take(&mut cell)),
            '\n' if !quoted => {
                cells.push(std::mem::take(&mut cell));
                records.push((begins, std::mem::take(&mut cells)));
                begins = line;
            }
            other => cell.push(other),
        }
    }
    records
}

#[cfg(test)]
mod tests {
    use super::super::row::csv_line;
    use super::records;

    #[test]
    fn records_read_back_and_half_ones_are_dropped() {
        let cells = [vec!["plain", "a, b", "say \"no\""], vec!["two\nlines", "", "end"]];
        let text: String = cells.iter().map(|cells| csv_line(cells)).collect();
        let read = records(&text);
        assert_eq!(read.iter().map(|(_, cells)| cells.clone()).collect::<Vec<_>>(), cells);
        assert_eq!(read.iter().map(|(line, _)| *line).collect::<Vec<_>>(), [1, 2]);
        for end in text.char_indices().map(|(at, _)| at).skip(1) {
            let expected = usize::from(end > csv_line(&cells[0]).len() - 1);
            assert_eq!(records(&text[..end]).len(), expected, "{:?}", &text[..end]);
        }
    }
}
