//! Collision solids, and what is precomputed about a mesh.
//!
//! `solid` is the entry point: a convex solid or a `MeshTree`. `mesh_tree` defines the tree of boxes, with the mesh's hull and
//! bounding volumes. `mesh_building` builds it from the triangles or from a record: `triangle_order` sorts the triangles,
//! `boxes` computes their boxes, `support_points` finds extreme points, `hull` makes the convex hull of them, `volumes` defines
//! ball and capsule. `mesh_record` stores the costly findings and proves that a stored one holds. `mesh_inside` tests whether a
//! closed mesh contains a point. Distances are not here; they are in the folder `distance`.

pub(crate) mod boxes;
pub(crate) mod hull;
pub(crate) mod mesh_building;
pub(crate) mod mesh_inside;
pub mod mesh_record;
pub mod mesh_tree;
pub mod solid;
pub(crate) mod support_points;
pub(crate) mod triangle_order;
pub mod volumes;
