//! Damped Gauss–Newton: from a start configuration onto the constraints of a program.
//!
//! `settings` defines the parameters of a solve and its outcome. `scalar` solves one problem. `lanes` runs the same algorithm
//! with one problem per lane, over a queue. `lane_jobs` brings problems to lanes and takes them away. `batch` feeds `lanes` with
//! many problems, and solves programs without a form for lanes by `scalar`; on request `single` takes the first steps in single
//! precision. `lane_values` only evaluates residuals at several configurations.

pub(crate) mod batch;
pub(crate) mod lane_jobs;
pub(crate) mod lane_values;
pub(crate) mod lanes;
pub(crate) mod scalar;
pub(crate) mod settings;
pub(crate) mod single;
