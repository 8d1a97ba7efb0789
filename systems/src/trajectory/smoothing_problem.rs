//! What smoothing reads, where straight lines stay on the leaf and where they do not.

use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::Model;
use crate::settings::SearchSettings;
use crate::trajectory::stretch::Stretch;
use foliate_kernels::trajectory::time_at_full_speed;

/// How much of the edges next to a corner its arc may take: half at most, since an edge has two ends.
pub(crate) const SHARES: [f64; 4] = [0.48, 0.24, 0.1, 0.03];

/// At a waypoint, such as a pregrasp, the arc takes less: the straight approach is there for a reason.
pub(crate) const AT_WAYPOINT: f64 = 0.3;

/// A stretch to be made smooth.
#[derive(Clone, Copy)]
pub(crate) struct SmoothingProblem<'a> {
    pub model: &'a Model,
    pub settings: &'a SearchSettings,
    pub motions: &'a [LeafMotion],
    pub stretch: &'a Stretch,
    /// By knot of the stretch: how often the curve was refused near it. Every time its arc is smaller, and at last the robot stops
    /// there, and with implicit rows goes straight to the next knot, as the path without times does.
    pub refusals: &'a [usize],
}

impl SmoothingProblem<'_> {
    pub(crate) fn size(&self) -> usize {
        self.model.problem.robot.space.size()
    }

    pub(crate) fn knots(&self) -> usize {
        self.stretch.knots.len() / self.size()
    }

    pub(crate) fn knot(&self, number: usize) -> &[f64] {
        &self.stretch.knots[number * self.size()..][..self.size()]
    }

    /// Seconds at full speed from a knot to the next.
    pub(crate) fn edge(&self, k: usize) -> f64 {
        time_at_full_speed(self.knot(k), self.knot(k + 1), &self.stretch.velocity)
    }
}
