//! Files that a mesh file names, such as the buffers of a glTF document: they lie where files may be read, and count as one with it.

use crate::scene::reading::error::{LoadStop, SceneError};
use crate::scene::reading::input;
use crate::scene::reading::limits::LoadLimits;
use crate::scene::sources::mesh_name::{Base, locate};
use crate::scene::sources::package::{PackagePath, Unresolved};
use crate::scene::sources::package_xml::PackagesBelow;
use sha2::{Digest, Sha256};
use std::path::Path;

/// Refuses a mesh file that would take `wanted` bytes of memory beside those that are `taken`, where that is more than there are, before it
/// is read.
pub(super) fn check_memory(limits: &LoadLimits, path: &Path, taken: u64, wanted: u64) -> Result<(), SceneError> {
    let name = path.display().to_string();
    limits.reached(&name)?;
    let wanted = taken.saturating_add(wanted);
    match limits.mesh_bytes {
        Some(most) if wanted > most => {
            let mib = |bytes: u64| bytes.div_ceil(1 << 20);
            let mut error = SceneError::stopped(&name, LoadStop::Memory);
            error.message = format!(
                "with this mesh, reading would take about {} MiB, more than the {} MiB left",
                mib(wanted),
                mib(most)
            );
            Err(error.hint("simplify the collision meshes, or raise the memory limit"))
        }
        _ => Ok(()),
    }
}

/// The files that one mesh file names.
pub(super) struct OuterFiles<'o> {
    path: &'o Path,
    packages: &'o PackagePath,
    below: &'o mut PackagesBelow,
    /// Bytes of memory that this and other meshes take.
    taken: u64,
    /// Bytes of memory that a byte of a file takes.
    working_bytes: u64,
    /// Bytes of the mesh file, and of those that it names.
    bytes: u64,
    /// SHA-256 of all of these, one after the other.
    sum: Sha256,
    /// Why there is no memory for one.
    refused: Option<SceneError>,
}

impl<'o> OuterFiles<'o> {
    /// Of a mesh file at a path, with its content.
    pub fn new(
        path: &'o Path,
        packages: &'o PackagePath,
        below: &'o mut PackagesBelow,
        taken: u64,
        working_bytes: u64,
        content: &[u8],
    ) -> Self {
        let (bytes, sum) = (content.len() as u64, Sha256::new_with_prefix(content));
        Self { path, packages, below, taken, working_bytes, bytes, sum, refused: None }
    }

    /// The bytes of a file that the mesh file names.
    ///
    /// # Errors
    /// The reason why it is not read, for a message that says where it is named.
    pub fn read(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let unresolved = |fault: Unresolved| match fault.hint.is_empty() {
            true => fault.message,
            false => {
                format!("{} ({})", fault.message, fault.hint.replace("the model's directory", "the mesh's directory"))
            }
        };
        let found = locate(name, &Base::of_file(self.path), self.packages, self.below).map_err(unresolved)?;
        let size = std::fs::metadata(&found).map_or(0, |metadata| metadata.len());
        self.bytes = self.bytes.saturating_add(size);
        if self.bytes > input::MESH_CAP {
            return Err(format!("with this file the mesh has more than the {} bytes that are read", input::MESH_CAP));
        }
        let wanted = size.saturating_mul(self.working_bytes);
        if let Err(error) = check_memory(self.packages.limits(), self.path, self.taken, wanted) {
            let message = error.message.clone();
            self.refused = Some(error);
            return Err(message);
        }
        self.taken = self.taken.saturating_add(wanted);
        let content = input::bytes(&found, size).map_err(|error| error.message)?;
        self.sum.update(&content);
        Ok(content)
    }

    /// The SHA-256 of the mesh file and of those that it names, in the order in which they were read.
    ///
    /// # Errors
    /// Where there was no memory, or no time, for one of them.
    pub fn finish(self) -> Result<[u8; 32], SceneError> {
        self.refused.map_or_else(|| Ok(self.sum.finalize().into()), Err)
    }
}
