//! Projection onto constraints: f(q) = 0 and g(q) = given, with everything that can be eliminated eliminated.
//!
//! A [`ConstraintProgram`] is compiled once per set of constraints and is immutable; right-hand sides (leaf parameters)
//! are arguments of each solve. [`project`] solves one candidate, [`project_batch`] many of them side by side in lanes;
//! [`project_motion`] keeps a whole motion on its leaf, [`project_motions`] many of them, one per lane; [`curve_residual`] proves
//! how far a curve over time is from one, [`curve_speed`] how fast a point moves along it.
//!
//! `rows` holds the parts of a program. `lane_rows` translates them into lanes, and `bounds` bounds them between two knots.
//! `program` compiles constraints into these parts. `newton` solves programs, and `path` makes motions of solves and bounds.

pub(crate) mod bounds;
pub(crate) mod lane_rows;
pub(crate) mod newton;
pub(crate) mod path;
pub(crate) mod program;
pub(crate) mod rows;

pub use crate::constrained_motion::bounds::point_rates::BoundMemory;
pub use crate::constrained_motion::bounds::residual_bound::ResidualBound;
pub use crate::constrained_motion::newton::batch::project_batch;
pub use crate::constrained_motion::newton::lane_jobs::Job;
pub use crate::constrained_motion::newton::scalar::project;
pub use crate::constrained_motion::newton::settings::{Outcome, Settings};
pub use crate::constrained_motion::path::constrained_path::MotionScratch;
pub use crate::constrained_motion::path::curve_residual::{CurveScratch, OffLeaf, curve_residual};
pub use crate::constrained_motion::path::curve_speed::curve_speed;
pub use crate::constrained_motion::path::motion::{project_motion, project_motions};
pub use crate::constrained_motion::path::settings::{MotionEnd, MotionJob, MotionSettings};
pub use crate::constrained_motion::program::constraint_program::{ConstraintProgram, Deviation};
pub use crate::constrained_motion::program::error::CompileError;
pub use crate::constrained_motion::program::scratch::Scratch;
pub use crate::constrained_motion::rows::rigid_attachment::{AttachmentTemplate, Relation};
