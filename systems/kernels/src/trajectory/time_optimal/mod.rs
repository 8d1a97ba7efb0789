//! Time-optimal parameterisation: the fastest curve over time along a path under limits of velocity and acceleration.
//!
//! `counted` finds the coordinates that count. `layout` lays a grid over the path, finer where it is curved and next to the rests at its
//! ends. `grid` evaluates the path there and writes the limits as linear programs, `reach` solves them, `passes` goes backward and
//! forward over the grid (TOPP-RA). `correction` looks at the curve between grid points and tightens limits where it exceeds them. `curve`
//! writes it (`straight` for straight pieces) and slows it down by what is left.

pub(crate) mod correction;
pub(crate) mod counted;
pub(crate) mod curve;
pub(crate) mod error;
pub(crate) mod grid;
pub(crate) mod layout;
pub(crate) mod passes;
pub(crate) mod reach;
pub(crate) mod settings;
pub(crate) mod straight;
pub(crate) mod timing;

pub use crate::trajectory::time_optimal::curve::TimedPath;
pub use crate::trajectory::time_optimal::error::TimingError;
pub use crate::trajectory::time_optimal::settings::TimingSettings;
pub use crate::trajectory::time_optimal::timing::{
    Ceiling, TimingReport, TimingScratch, time_optimal, time_optimal_below,
};
