//! Readers of mesh formats, one file each: COLLADA (`dae`), glTF, OBJ, PLY, STL. All of them fill the `Triangles` of `triangles`.

pub(crate) mod dae;
pub(crate) mod dae_materials;
pub(crate) mod dae_values;
pub(crate) mod gltf;
pub(crate) mod gltf_document;
pub(crate) mod obj;
pub(crate) mod ply;
pub(crate) mod stl;
pub(crate) mod triangles;
