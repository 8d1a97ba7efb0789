//! TODO(page): what lies in collision/convex.

pub mod core;
pub(crate) mod gjk;
pub(crate) mod segments;
pub(crate) mod simplex;

pub use crate::collision::convex::core::{Convex, Core, closest_on_triangle};
