//! Projection onto constraints: f(q) = 0 and g(q) = given, with everything that can be eliminated eliminated.
//!
//! A [`ConstraintProgram`] is compiled once per set of constraints and is immutable; right-hand sides (leaf parameters)
//! are arguments of each solve. [`project`] solves one candidate, [`project_batch`] many of them side by side in lanes;
//! [`project_motion`] keeps a whole motion on its leaf, [`project_motions`] many of them, one per lane.

mod batch;
mod blocks;
mod bodies;
mod carriage;
mod compile;
mod function_bound;
mod hessian_bound;
mod lane_balance;
mod lane_motion;
mod lane_newton;
mod lane_program;
mod lane_rows;
mod lane_values;
mod merge;
mod motion;
mod newton;
mod point_rates;
mod program;
mod scratch;
mod seeds;
mod walk;

pub use batch::{Job, project_batch};
pub use carriage::{CarriageTemplate, Relation};
pub use compile::CompileError;
pub use hessian_bound::ResidualBound;
pub use motion::{MotionEnd, MotionJob, MotionScratch, MotionSettings, project_motion, project_motions};
pub use newton::{Outcome, Settings, project};
pub use point_rates::BoundMemory;
pub use program::{ConstraintProgram, Deviation};
pub use scratch::Scratch;
pub use seeds::{SEEDS, SeedTable, SeedTarget};
