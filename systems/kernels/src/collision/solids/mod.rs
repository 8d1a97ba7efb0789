//! TODO(page): what lies in collision/solids.

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
