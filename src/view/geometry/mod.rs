//! Meshes of a page: small, shared, in a binary blob.
//!
//! `blob` collects arrays, `grid` puts a mesh onto 16-bit numbers, `quadric` and `decimation` take triangles away that change little,
//! `mesh_store` does all of that for the meshes of one page.

pub(crate) mod blob;
pub(crate) mod decimation;
pub(crate) mod grid;
pub(crate) mod mesh_store;
pub(crate) mod quadric;
