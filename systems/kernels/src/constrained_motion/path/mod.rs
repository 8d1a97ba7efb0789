//! Motions that satisfy the constraints between their knots too.
//!
//! `settings` defines the parameters of a motion and how it ends. `constrained_path` proposes each step and judges the result.
//! `motion` is the entry point: it solves one motion in scalar code, or many by `lane_motion`, which gives each motion a lane.
//! Both follow a `constrained_path` and solve its steps with `newton`.
//!
//! `curve_residual` does not follow a leaf: it proves how far a given curve is from one. `curve_speed` bounds how fast a point moves
//! along one.
//!
//! The bound on second derivatives (`bounds`) adds up how far every joint turns, whatever cancels, and so is often ten
//! times what the rows really do. Where a step is too long for it, the rows are evaluated in between: in each of n equal parts
//! they leave the larger of the residuals at its ends by at most 1/n² of the bound. An evaluation costs a fraction of a knot.
//!
//! No step bridges two branches of a leaf. The bound on second derivatives holds for the whole straight line between two
//! knots, so everything on it is within the path tolerance of the constraints: it could only lead from one branch to
//! another where those are that close, and there the line is as good a motion as any. The comparison of lengths
//! (`MotionSettings::jump`) merely finds out sooner.

pub(crate) mod constrained_path;
pub(crate) mod curve_residual;
pub(crate) mod curve_speed;
pub(crate) mod lane_motion;
pub(crate) mod motion;
pub(crate) mod settings;
