//! TODO(page): what lies in collision/distance.

pub(crate) mod boxes_in_lanes;
pub mod hull_distance;
pub(crate) mod mesh_distance;
pub mod query;
pub(crate) mod triangles_in_lanes;

pub use crate::collision::convex::gjk::Ask;
pub use crate::collision::distance::query::clearance;
pub use crate::collision::solids::solid::Solid;
