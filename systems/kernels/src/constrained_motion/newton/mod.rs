//! Damped Gauss–Newton: from a start configuration onto the constraints of a program.
//!
//! `settings` defines the parameters of a solve and its outcome. `scalar` solves one problem. `lanes` runs the same algorithm
//! with one problem per lane, over a queue. `batch` feeds `lanes` with many problems, in single and then in double precision,
//! and solves programs without a form for lanes by `scalar`. `lane_values` only evaluates residuals at several configurations;
//! it fills lanes as `batch` does. `seeds` proposes start configurations and depends on none of the solvers.

pub(crate) mod batch;
pub(crate) mod lane_values;
pub(crate) mod lanes;
pub(crate) mod scalar;
pub(crate) mod seeds;
pub(crate) mod settings;
