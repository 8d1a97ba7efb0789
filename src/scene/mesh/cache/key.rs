//! The key of a cache entry: a hash of the mesh file, of how it is read, and of the versions of reader and record.

use crate::scene::mesh::cache::directory;
use crate::scene::mesh::formats::triangles::UpAxis;
use foliate_components::robot::shape::mesh_record::MeshRecord;
use glam::DVec3;
use sha2::{Digest, Sha256};
/// Counts changes of how files of meshes are read; entries of other versions are not found.
const READING_VERSION: u32 = 2;

/// Which entry: what the file holds, and how it is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Key(pub(crate) [u8; 32]);

impl Key {
    /// Of a file by the SHA-256 of its bytes, the reader that its extension names, and what is done to its coordinates.
    pub(crate) fn new(sha256: &[u8; 32], reader: &str, up_axis: UpAxis, scale: DVec3) -> Self {
        let mut hash = Sha256::new();
        for version in [VERSION, READING_VERSION, MeshRecord::VERSION] {
            hash.update(version.to_le_bytes());
        }
        hash.update([reader.len() as u8]);
        hash.update(reader);
        hash.update([match up_axis {
            UpAxis::AsWritten => 0,
            UpAxis::Declared => 1,
        }]);
        for factor in scale.to_array() {
            hash.update(factor.to_bits().to_le_bytes());
        }
        hash.update(sha256);
        Self(hash.finalize().into())
    }

    pub(crate) fn name(&self) -> String {
        let digits: String = self.0.iter().map(|b| format!("{b:02x}")).collect();
        digits + directory::EXTENSION
    }
}

/// Counts changes of the form. It is part of the key.
pub(crate) const VERSION: u32 = 2;
