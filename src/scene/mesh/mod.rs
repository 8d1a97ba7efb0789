//! Triangle meshes from STL, OBJ, PLY, COLLADA and glTF files: strict readers with caps, in metres.
//!
//! COLLADA units and node transforms are applied. The declared up axis is not, unless asked for: ROS, pinocchio and coal
//! take mesh coordinates as the link's, and published models rely on it (TIAGo's collision meshes declare `Y_UP` and agree
//! with its STL meshes only as they are written).
//!
//! `meshes` loads the meshes of a model: it reads triangles by `formats`, and takes what is costly to derive from them out
//! of `cache`. `outer_files` are those that a mesh file names.

pub(crate) mod cache;
pub(crate) mod formats;
pub(crate) mod meshes;
mod outer_files;
