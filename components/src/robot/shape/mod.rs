//! Collision shapes: primitives and meshes, which triangles of a mesh enclose a solid, volumes, and what was found out about a mesh before.

pub mod closed_surface;
pub mod geometry;
pub mod mesh_record;
pub mod positions;
pub(crate) mod volume;

pub use crate::robot::shape::geometry::{Geometry, Mesh};
