//! What a setup asks of solids: points on their surfaces (`surface_points`), their convex hulls (`hull`).

pub(crate) mod hull;
pub(crate) mod surface_points;
