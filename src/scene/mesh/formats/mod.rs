//! Readers of mesh formats, one file each: COLLADA (`dae`), OBJ, STL. All of them fill the `Triangles` of `triangles`.

pub(crate) mod dae;
pub(crate) mod dae_materials;
pub(crate) mod dae_values;
pub(crate) mod obj;
pub(crate) mod stl;
pub(crate) mod triangles;
