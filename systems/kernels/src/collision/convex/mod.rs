//! Convex solids, and the distance of two of them.
//!
//! `core` defines a convex solid as a core and a radius, with support functions. `simplex` finds the point of a simplex that is
//! closest to the origin; `core` uses it for points of triangles. `gjk` iterates over `core` and `simplex` and returns a
//! certified lower bound of the distance. `segments` is the closed form for two segments and depends on none of them.

pub mod core;
pub(crate) mod gjk;
pub(crate) mod segments;
pub(crate) mod simplex;

pub use crate::collision::convex::core::{Convex, Core, closest_on_triangle};
