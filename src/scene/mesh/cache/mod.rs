//! What trees of meshes are built from, on disk, under the SHA-256 of the file that a mesh comes from.
//!
//! A mesh's file is always read: vertices and triangles are never kept. What is spared is to search for its hull and for the
//! order of its tree. No one who may write into the directory can make the program believe in another shape: a record counts
//! for nothing unless it is proved of the mesh that was read (`foliate_kernels::collision::solids::mesh_record::proves`),
//! and one that is proved changes no distance. What is not right is found anew and written over. No failure of the disk is
//! an error.
//!
//! `mesh_cache` finds and keeps records: under a name by `key`, as bytes by `entry`, in files by `directory`.

pub(crate) mod directory;
pub(crate) mod entry;
pub(crate) mod key;
pub(crate) mod mesh_cache;
