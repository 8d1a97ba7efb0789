//! Curves through configurations: along a path, and over time.
//!
//! A [`Spline`] is a cubic Hermite spline through whole configurations; [`Cubic`] is one coordinate of one piece, with its extremes in closed
//! form. A path becomes one by [`blend_polyline`] (corners become arcs) or [`spline_through`] (dense knots of a manifold), both with
//! [`time_at_full_speed`] as length. [`time_optimal`] gives it times, and [`peak_rates`] says exactly how much of its limits a curve over time
//! uses. [`limit_jerk`] bounds the jerk of a curve over time.

pub(crate) mod blend;
pub(crate) mod cubic;
mod editing;
pub(crate) mod jerk;
pub(crate) mod metric;
pub(crate) mod peak_rates;
pub(crate) mod spline;
pub(crate) mod through_knots;
pub(crate) mod time_optimal;

pub use crate::trajectory::blend::{BlendError, blend_corner, blend_polyline};
pub use crate::trajectory::cubic::Cubic;
pub use crate::trajectory::jerk::{JerkError, JerkReport, JerkScratch, limit_jerk};
pub use crate::trajectory::metric::time_at_full_speed;
pub use crate::trajectory::peak_rates::{Limits, Peak, PeakRates, acceleration_jump, peak_rates};
pub use crate::trajectory::spline::{Spline, SplineError};
pub use crate::trajectory::through_knots::{ThroughScratch, spline_through};
pub use crate::trajectory::time_optimal::{
    Ceiling, TimedPath, TimingError, TimingReport, TimingScratch, TimingSettings, time_optimal, time_optimal_below,
};
