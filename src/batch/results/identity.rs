//! Whether what an earlier run of a batch has left is of the same batch.

use crate::batch::entry::Entry;
use crate::batch::error::{BatchError, write_whole};
use crate::batch::results::kept::read_text;
use crate::scene::sources::source::hexadecimal;
use foliate_components::problem::Problem;
use foliate_components::robot::shape::Geometry;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// What decides the rows of a batch, by name: everything but the number of threads. It stands in `settings.json`.
#[derive(Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Identity(pub BTreeMap<String, String>);

impl Identity {
    /// Writes `settings.json`.
    pub(crate) fn write(&self, out: &Path) -> Result<(), BatchError> {
        let path = out.join("settings.json");
        let text = serde_json::to_string_pretty(self)
            .map_err(|e| BatchError::Io { path: path.clone(), source: std::io::Error::other(e) })?;
        write_whole(&path, &(text + "\n"))
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
    hexadecimal(&hash.0.finalize().into())
}
