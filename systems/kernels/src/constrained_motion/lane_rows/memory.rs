//! The working memory of a solve in lanes, in single or double precision.
//!
//! `LaneMemory` holds the inputs of each lane (coordinates, given poses), the rows and the state of the iteration. It grows to
//! the largest program and is then reused without allocation. It is apart from `newton`, because `Scratch` owns it.

use crate::constrained_motion::lane_rows::form::LaneProgram;
use crate::kinematics::lane_steps::POSE_ROWS;

/// What lanes work in, and where problems are put.
#[derive(Clone, Debug, Default)]
pub(crate) struct LaneMemory<R> {
    /// One row per coordinate.
    pub q: Vec<R>,
    /// [`POSE_ROWS`] rows per pose that a problem is given.
    pub given: Vec<R>,
    pub(crate) bodies: Vec<R>,
    /// One row per row of the program.
    pub values: Vec<R>,
    pub(crate) jacobian: Vec<R>,
    /// Vectors that a block works with.
    pub(crate) vectors: Vec<R>,
    pub(crate) multipliers: Vec<R>,
    pub(crate) gram: Vec<R>,
    pub(crate) step: Vec<R>,
    /// For each variable the lanes (bits) at its upper and at its lower bound.
    pub(crate) at_bounds: Vec<[u32; 2]>,
    /// And those in which it keeps still.
    pub(crate) frozen: Vec<u32>,
    /// Smallest squared residual so far from which the next halving counts.
    pub(crate) best: R,
    pub(crate) since_halved: R,
    pub(crate) iterations: R,
    pub(crate) residual: R,
}

impl<R: Copy + Default> LaneMemory<R> {
    /// Makes room for a program; allocates only where an earlier one needed less.
    pub(crate) fn prepare(&mut self, program: &LaneProgram, coordinates: usize) {
        let (rows, width) = (program.rows, program.moves.len());
        grow(&mut self.q, coordinates);
        grow(&mut self.given, program.givens.len() * POSE_ROWS);
        grow(&mut self.bodies, program.steps.len() * POSE_ROWS);
        grow(&mut self.values, rows);
        grow(&mut self.jacobian, rows * width);
        grow(&mut self.vectors, 3 * program.vectors);
        grow(&mut self.multipliers, rows);
        grow(&mut self.gram, rows * rows);
        grow(&mut self.step, width);
        if self.frozen.len() < width {
            self.frozen.resize(width, 0);
            self.at_bounds.resize(width, [0; 2]);
        }
    }
}

fn grow<R: Copy + Default>(rows: &mut Vec<R>, count: usize) {
    if rows.len() < count {
        rows.resize(count, R::default());
    }
}
