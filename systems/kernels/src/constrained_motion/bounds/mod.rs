//! Bounds on the residual between two knots of a motion.
//!
//! `joint_links` lists the free motions of the joints between two frames. `point_rates` uses them to bound velocity and
//! curvature of weighted sums of points. `function_bound` uses both for rows of balance, distances and custom functions.
//! `residual_bound` is the entry point: it bounds relative poses and placements itself and delegates the rest to
//! `function_bound`. The folder `path` uses the result to choose the length of its steps.

pub(crate) mod function_bound;
pub(crate) mod joint_links;
pub(crate) mod point_rates;
pub(crate) mod residual_bound;
