//! What can collide with what: the solids of a robot, the pairs to test, and the queries on one pair.
//!
//! * `scene_solid` prepares each collision shape. It stores a bounding volume (`bounding`) and an inscribed volume (`inscribed`) with it.
//! * `pair_filter` decides which links are tested against which. `adjacent` proposes neighbours to leave out, and `coverage`
//!   reports the pairs that are left out.
//! * `collision_scene` puts solids, joints and pairs together. It is immutable and holds for every leaf.
//! * `body_chains` finds the joints above each body on one leaf, from the scene and its rigid attachments. `pair_set` uses them to select
//!   the pairs that matter on that leaf.
//! * `pair_query` computes clearance and containment of one pair. It builds on `collision_scene` and on the folder `distance`;
//!   `adjacent` and `coverage` build on it.

pub(crate) mod adjacent;
pub(crate) mod body_chains;
pub(crate) mod bounding;
pub mod collision_scene;
pub(crate) mod coverage;
pub(crate) mod inscribed;
pub(crate) mod pair_filter;
pub mod pair_query;
pub mod pair_set;
pub mod scene_solid;

pub use crate::collision::scene::collision_scene::{Cluster, CollisionScene, Group, Pair, PairId};
pub use crate::collision::scene::scene_solid::SceneSolid;
