//! TODO(page): what lies in scene.

pub(crate) mod assemble;
pub mod load;
pub(crate) mod mesh;
pub mod reading;
pub(crate) mod shipped;
pub(crate) mod sources;
pub(crate) mod srdf;
pub(crate) mod urdf;

pub use crate::scene::assemble::names::configuration::coordinate_names;
pub use crate::scene::assemble::scene::{PartSource, Scene, SceneFile, SceneOrigin};
pub use crate::scene::load::{ReadModel, load_scene, load_scene_text, read_model};
pub use crate::scene::mesh::cache::mesh_cache::MeshCache;
pub use crate::scene::mesh::formats::triangles::UpAxis;
pub use crate::scene::reading::cache_folders::model_cache;
pub use crate::scene::reading::error::{LoadStop, SceneError};
pub use crate::scene::reading::limits::LoadLimits;
pub use crate::scene::shipped::{ShippedScene, shipped_scenes};
pub use crate::scene::sources::package::PackagePath;
pub use crate::scene::sources::source::{ModelFile, Origin, sha256};
