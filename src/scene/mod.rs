//! Reading: scene files, robot descriptions and meshes, and where to find them.
//!
//! Input is hostile: sizes, depths and counts have caps, numbers are finite, links out of packages are not followed, and
//! every refusal is a [`SceneError`] with file, line and element.
//!
//! `load` is the entrance for files, `shipped` for embedded scenes. Both call `assemble`, which makes a problem of a scene
//! file. It finds the files of models by `sources` and reads them by `urdf`, `srdf` and `mesh`. All of these read by means
//! of `reading`. `visuals` is what links look like, `surface` their solids as triangles.

pub(crate) mod assemble;
pub mod load;
pub(crate) mod mesh;
pub mod reading;
pub(crate) mod shipped;
pub(crate) mod sources;
pub(crate) mod srdf;
#[cfg(feature = "visuals")]
pub(crate) mod surface;
pub(crate) mod urdf;
#[cfg(feature = "visuals")]
pub(crate) mod visuals;

pub use crate::scene::assemble::names::configuration::coordinate_names;
pub use crate::scene::assemble::names::start_file::StartFile;
pub use crate::scene::assemble::scene::{PartSource, Scene, SceneFile, SceneOrigin};
pub use crate::scene::load::{ReadModel, read_model};
pub use crate::scene::mesh::cache::mesh_cache::MeshCache;
pub use crate::scene::mesh::formats::triangles::UpAxis;
pub use crate::scene::reading::cache_folders::model_cache;
pub use crate::scene::reading::error::{ErrorSource, LoadStop, SceneError};
pub use crate::scene::reading::limits::LoadLimits;
pub use crate::scene::shipped::{ShippedScene, shipped_scenes};
pub use crate::scene::sources::package::PackagePath;
pub use crate::scene::sources::source::{ModelFile, Origin, sha256};
pub use crate::scene::sources::xacro::XacroUse;
#[cfg(feature = "visuals")]
pub use crate::scene::surface::Surface;
#[cfg(feature = "visuals")]
pub use crate::scene::visuals::{Visual, Visuals};
