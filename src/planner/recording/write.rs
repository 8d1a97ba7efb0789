//! From a recording to its file.

use crate::os::output;
use crate::planner::recording::columns;
use crate::planner::recording::document::Recording;
use crate::planner::recording::error::RecordingError;
use std::path::Path;

impl Recording {
    /// The bytes of its file: the head as one line of JSON, then the columns. A search with the same seed has the same bytes on any number of
    /// threads.
    ///
    /// # Errors
    /// A number is not finite, so that JSON has no word for it.
    pub fn to_bytes(&self) -> Result<Vec<u8>, serde_json::Error> {
        let mut bytes = serde_json::to_vec(&self.head)?;
        bytes.push(b'\n');
        columns::append(self, &mut bytes);
        Ok(bytes)
    }

    /// Writes it to a file: whole or not at all, see [`crate::os::output`].
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&self, out: &Path) -> Result<(), RecordingError> {
        let json = |source| RecordingError::Json { path: out.to_owned(), place: "the head".into(), source };
        let io = |source| RecordingError::Io { path: out.to_owned(), source };
        output::write(out, &self.to_bytes().map_err(json)?).map_err(io)
    }
}
