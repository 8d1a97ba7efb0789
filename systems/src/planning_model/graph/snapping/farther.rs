//! Of a configuration that lies in no state and in reach of none: which state is nearest, and what would have to be moved.

use crate::planning_model::graph::snapping::nearby::{Nearby, ON};
use foliate_components::graph::ConstraintKind;
use foliate_components::infeasibility::NearestState;
use foliate_components::problem::Problem;
use foliate_kernels::kinematics::Kinematics;

/// How many times the tolerance is looked around, in turn: up to 5 m with the usual one.
const FACTORS: [f64; 6] = [1.0, 4.0, 16.0, 64.0, 256.0, 1024.0];

/// The state nearest to a configuration, with the constraint of it that is farthest off; `None` where none is found.
pub(crate) fn nearest_state(problem: &Problem, kinematics: &Kinematics, q: &[f64]) -> Option<NearestState> {
    let nearby = Nearby::new(problem, kinematics)?;
    let X_WJ = nearby.poses(q);
    let (state, corrected) = FACTORS.iter().find_map(|&factor| nearby.nearest(q, &X_WJ, factor))?;
    let residuals = nearby.manifold(&state).into_iter().map(|kind| (kind, nearby.residual(kind, q, &X_WJ)));
    let (kind, residual) = residuals.filter(|(_, residual)| *residual > ON).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let keys = nearby.state_keys();
    let mut nearest = NearestState::new(keys.state_name(&state), keys.describe(kind).0, residual);
    if let ConstraintKind::Placement { object, on } = kind {
        nearest.off = nearby.place(object, on).and_then(|place| place.resting.off(&X_WJ)).map(Box::new);
    }
    nearest.corrections = nearby.told(None, &state, &corrected);
    nearest.tolerance = problem.start_tolerance;
    Some(nearest)
}
