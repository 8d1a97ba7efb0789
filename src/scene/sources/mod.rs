//! Where the files of a scene are: the search for packages, and the files that names lead to.
//!
//! `package` resolves `package://` URLs: by the search list, and by `package_xml` up and down from where one is. `program_files` are models in the
//! program. `mesh_name` finds the files of meshes; both it and `package` `follow` links before they say whether a file may be read. `source` opens
//! models, and has `xacro` files expanded. `follower_limits` opens a model's URDF again to name the lines of joints whose followers leave them no
//! room.

pub(crate) mod follow;
pub(crate) mod follower_limits;
pub(crate) mod mesh_name;
pub(crate) mod package;
pub(crate) mod package_xml;
pub(crate) mod program_files;
pub(crate) mod source;
pub(crate) mod xacro;
