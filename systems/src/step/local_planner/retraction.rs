//! Retraction: a motion that is blocked goes on along the surface of what is in its way.
//!
//! What would bring the two shapes closer is taken out of the motion, and a push that sets them apart is added: Zhang and Manocha, *An
//! efficient retraction-based RRT planner* (ICRA 2008), with the gradient of the distance in place of a search for the closest
//! contact configuration.

use crate::step::local_planner::leaf_space::{LeafScratch, LeafSpace};
use foliate_components::Pose;
use foliate_kernels::collision::{
    DistanceQuery, PairId, body_poses, hull_gap_along, pair_clearance, separating_direction,
};
use glam::DVec3;

/// By so much a push sets the two shapes apart, metres.
const PUSH: f64 = 0.02;

/// Step of the difference quotient, radians or metres. Distances are exact to within rounding, so that it need not be larger.
const DIFFERENCE: f64 = 1e-4;

/// By such a step no distance grows by more, metres: farther apart than this is not asked.
const MOST_CHANGE: f64 = 0.01;

/// Poses that differ by less are the same, metres and radians.
const ROUNDING: f64 = 1e-11;

/// Squared gradients below this say nothing, 1 / weighted metre².
const FLAT: f64 = 1e-9;

impl LeafSpace<'_> {
    /// From `q`, where a motion to `target` is blocked by a pair of shapes: the configuration to turn to. `None` where the pair does not
    /// depend on what moves, the motion does not bring it closer, or nothing on the leaf is near.
    pub fn retract(&self, q: &[f64], target: &[f64], pair: PairId, scratch: &mut LeafScratch) -> Option<Vec<f64>> {
        let (space, weights) = (&self.model.problem.robot.space, &self.model.robot_weights);
        // About as much as a motion: an exact distance for each joint.
        scratch.work += 1;
        let mut motion = vec![0.0; space.dimension()];
        space.difference(q, target, &mut motion);
        let gradient = self.gradient(q, &motion, pair, scratch);
        let approach: f64 = gradient.iter().zip(&motion).map(|(slope, by)| slope * by).sum();
        let weighed = |(slope, weight): (&f64, &f64)| if *weight > 0.0 { (slope / weight).powi(2) } else { 0.0 };
        let square: f64 = gradient.iter().zip(weights).map(weighed).sum();
        // Compared so that NaN is no gradient.
        let is_steep = square > FLAT;
        if !is_steep || approach >= 0.0 {
            return None;
        }
        let factor = (PUSH - approach) / square;
        for (index, by) in motion.iter_mut().enumerate().filter(|(index, _)| weights[*index] > 0.0) {
            *by += factor * gradient[index] / weights[index].powi(2);
        }
        let mut aside = vec![0.0; q.len()];
        space.integrate(q, &motion, &mut aside);
        space.clamp(&mut aside);
        self.model.lock(&mut aside);
        self.project(&mut aside, scratch).then_some(aside)
    }

    /// How the distance of a pair grows with each velocity coordinate of the robots that a motion changes, metres per unit.
    fn gradient(&self, q: &[f64], motion: &[f64], pair: PairId, scratch: &mut LeafScratch) -> Vec<f64> {
        let (space, weights, scene) =
            (&self.model.problem.robot.space, &self.model.robot_weights, &self.model.collision);
        let relative = |X_WJ: &[Pose]| {
            let [X_WA, X_WB] = body_poses(scene, pair, X_WJ);
            X_WA.inverse() * X_WB
        };
        let mut moved = q.to_vec();
        self.carry(&mut moved, scratch);
        let X_AB = relative(&scratch.X_WJ);
        // To first order the distance of hulls changes as their gap along the direction in which they are nearest.
        let along = separating_direction(scene, pair, &scratch.X_WJ);
        let mut hint = DVec3::ZERO;
        let mut distance = |X_WJ: &[Pose], most: f64| match along {
            Some(n) => hull_gap_along(scene, pair, X_WJ, n),
            None => pair_clearance(scene, pair, X_WJ, DistanceQuery::exact(most), &mut hint),
        };
        let here = distance(&scratch.X_WJ, f64::MAX);
        let mut by = vec![0.0; motion.len()];
        let mut gradient = vec![0.0; motion.len()];
        for index in (0..motion.len()).filter(|&index| weights[index] > 0.0 && motion[index] != 0.0) {
            by[index] = DIFFERENCE;
            space.integrate(q, &by, &mut moved);
            by[index] = 0.0;
            self.carry(&mut moved, scratch);
            if is_same(&X_AB, &relative(&scratch.X_WJ)) {
                continue;
            }
            gradient[index] = (distance(&scratch.X_WJ, here + MOST_CHANGE) - here) / DIFFERENCE;
        }
        gradient
    }
}

/// Whether two poses differ by rounding alone.
fn is_same(a: &Pose, b: &Pose) -> bool {
    let by = a.inverse() * *b;
    by.translation.length() < ROUNDING && by.rotation.xyz().length() < ROUNDING
}
