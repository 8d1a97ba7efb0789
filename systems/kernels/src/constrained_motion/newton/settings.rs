//! Settings and outcome of a solve.
//!
//! They are apart, because the scalar solver, the solver in lanes and the motions in `path` share them.

use crate::lanes::level::Level;

/// How a solve works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// A solve has converged when no row is larger than this; metres and radians.
    pub tolerance: f64,
    /// Largest number of Newton steps.
    pub iterations: u32,
    /// Largest change of a coordinate in one step, radians or metres.
    pub step_limit: f64,
    /// A solve is given up when the squared residual has not halved in this many steps.
    pub patience: u32,
    /// λ² = `damping` · |e|² + `damping_floor`.
    pub damping: f64,
    /// See `damping`.
    pub damping_floor: f64,
    /// Residual down to which [`project_batch`](crate::constrained_motion::newton::batch::project_batch) steps in single
    /// precision, sixteen problems at a time, metres and radians; 0 for double precision throughout. What does not come so far
    /// has failed; what does is finished, and judged, in double precision. Below about 1e-5 rounding may be in the way.
    pub single_until: f64,
    /// Instructions with which [`project_batch`](crate::constrained_motion::newton::batch::project_batch) works; one problem
    /// alone is solved in scalar code, but for the linear systems of many rows.
    pub level: Level,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance: 1e-6,
            iterations: 40,
            step_limit: 0.7,
            patience: 6,
            damping: 1e-3,
            damping_floor: 1e-9,
            single_until: 0.0,
            level: Level::detected(),
        }
    }
}

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// All rows are within the tolerance, all free coordinates within their bounds, eliminated objects in place.
    Converged {
        /// Newton steps taken.
        iterations: u32,
        /// Largest row.
        residual: f64,
    },
    /// The residual stopped falling: a local minimum, or out of reach.
    Stagnated {
        /// Newton steps taken.
        iterations: u32,
        /// Largest row.
        residual: f64,
    },
    /// The limit of iterations was reached.
    LimitReached {
        /// Largest row.
        residual: f64,
    },
    /// A constraint that no free coordinate can change does not hold: no start would converge.
    Contradicted {
        /// Which: index among the constraints of
        /// [`ConstraintProgram::compile`](crate::constrained_motion::program::constraint_program::ConstraintProgram::compile),
        /// rigid attachments counted before them.
        constraint: usize,
        /// Its largest row.
        residual: f64,
    },
    /// Rows are satisfied, but the root of a robot that stands on a foot is out of its bounds.
    RootOutOfBounds,
    /// Configuration or arguments do not fit the program: wrong length, not finite, or a placement's parameter that names
    /// polygons it does not have.
    Malformed,
    /// Nothing has been tried yet.
    Idle,
}

impl Outcome {
    /// Whether the configuration satisfies the program.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        matches!(self, Self::Converged { .. })
    }
}
