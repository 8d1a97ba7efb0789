//! Distance of two solids at given poses.
//!
//! `query` is the entry point: closed forms for round solids, GJK (`convex/gjk.rs`) for other convex ones, `mesh_distance` for
//! meshes. `mesh_distance` descends the trees of meshes; it uses `boxes_in_lanes` for eight boxes at once and
//! `triangles_in_lanes` for eight triangles at once. `hull_distance` gives the cheaper distance of the hulls; it needs GJK
//! alone. `witness` finds the nearest points for a distance that is known.

pub(crate) mod boxes_in_lanes;
pub mod hull_distance;
pub(crate) mod mesh_distance;
pub mod query;
pub(crate) mod triangles_in_lanes;
pub mod witness;

pub use crate::collision::convex::gjk::DistanceQuery;
pub use crate::collision::distance::query::clearance;
pub use crate::collision::solids::solid::Solid;
