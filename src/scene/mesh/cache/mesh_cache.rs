//! The cache as callers see it: finds the record of a mesh, proves it, and keeps a new one where there is none.

use crate::scene::mesh::cache::key::Key;
use crate::scene::mesh::cache::{directory, entry};
use crate::scene::reading::cache_folders::user_cache;
use foliate_components::robot::shape::mesh_record::MeshRecord;
use std::path::{Path, PathBuf};

/// Entries of smaller files would save a third of some tens of microseconds; of files below one or two thousand bytes nothing at all.
pub(crate) const SMALLEST_FILE: usize = 4 << 10;
/// Largest entry, bytes.
const LARGEST_ENTRY: u64 = 64 << 20;
/// Most bytes of all entries together, unless told otherwise.
const MOST_BYTES: u64 = 256 << 20;

/// A directory in which what was found about meshes is kept between runs; never the meshes themselves. Nothing is
/// written by a library that was not given one:
/// [`PackagePath::with_mesh_cache`](crate::scene::sources::package::PackagePath::with_mesh_cache).
///
/// Everything in it may be deleted at any time. Processes may share it.
#[derive(Clone, Debug)]
pub struct MeshCache {
    directory: PathBuf,
    most_bytes: u64,
}

/// What there is under a key.
pub(crate) enum Kept {
    /// A claim about the mesh: to be proved.
    Record(MeshRecord),
    /// An entry that is not what it should be, and why.
    Bad(String),
    Nothing,
}

impl MeshCache {
    /// In a directory, which is made when there is something to keep. Entries are called `….mesh`; other files are left alone.
    #[must_use]
    pub fn in_directory(directory: impl Into<PathBuf>) -> Self {
        Self { directory: directory.into(), most_bytes: MOST_BYTES }
    }

    /// In the directory `FOLIATE_MESH_CACHE`, or `foliate/meshes` in the user's cache directory; none where there is neither.
    #[must_use]
    pub fn of_user() -> Option<Self> {
        user_cache("FOLIATE_MESH_CACHE", "meshes").map(Self::in_directory)
    }

    /// Keeps at most this many bytes (256 MiB where nothing is said): the entries written first go first.
    #[must_use]
    pub fn at_most(mut self, bytes: u64) -> Self {
        self.most_bytes = bytes;
        self
    }

    /// Where it is.
    #[must_use]
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// What is kept for a mesh. `buffer` is written over.
    pub(crate) fn find(&self, key: &Key, buffer: &mut Vec<u8>) -> Kept {
        match directory::read(&self.path(key), LARGEST_ENTRY, buffer) {
            Ok(true) => {}
            Ok(false) => return Kept::Nothing,
            Err(why) => return Kept::Bad(why),
        }
        match entry::read(buffer, key) {
            Ok(record) => Kept::Record(record),
            Err(why) => Kept::Bad(why.into()),
        }
    }

    /// Keeps a record; whether it is kept. What is there already is replaced.
    pub(crate) fn keep(&self, key: &Key, record: &MeshRecord) -> bool {
        let Some(bytes) = entry::write(key, record).filter(|bytes| bytes.len() as u64 <= LARGEST_ENTRY) else {
            return false;
        };
        directory::write(&self.directory, &key.name(), &bytes).is_ok()
    }

    /// Lets the oldest entries go, as far as there are more bytes than wanted.
    pub(crate) fn trim(&self) {
        directory::trim(&self.directory, self.most_bytes);
    }

    /// Where an entry is.
    pub(crate) fn path(&self, key: &Key) -> PathBuf {
        self.directory.join(key.name())
    }
}
