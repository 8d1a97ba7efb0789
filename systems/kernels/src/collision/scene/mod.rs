//! TODO(page): what lies in collision/scene.

pub(crate) mod adjacent;
pub(crate) mod attachment;
pub(crate) mod bounding;
pub mod collision_scene;
pub(crate) mod coverage;
pub(crate) mod inscribed;
pub(crate) mod pair_filter;
pub mod pair_query;
pub mod pair_set;
pub(crate) mod scene_joint;
pub mod scene_solid;

pub use crate::collision::scene::collision_scene::{Cluster, CollisionScene, Group, Pair, PairId};
pub use crate::collision::scene::scene_solid::SceneSolid;
