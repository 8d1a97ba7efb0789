//! TODO(page): what lies in constrained_motion/bounds.

pub(crate) mod function_bound;
pub(crate) mod joint_links;
pub(crate) mod point_rates;
pub(crate) mod residual_bound;
