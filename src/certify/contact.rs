//! What is said about a contact: how deep, and how long.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use super::advance::{Budget, Met};
use super::depth::{Placed, depth};
use super::motion::Motion;
use super::report::ContactReport;
use super::world::{Certifier, Phase};
use foliate_components::Pose;
use foliate_kernels::collision::{Ask, PairId, contained, pair_clearance};
use glam::DVec3;

/// Places behind a contact at which the pair is looked at, each a fixed share of what is left of the motion away.
const PLACES: u32 = 256;

impl Certifier {
    /// Follows a pair from where it meets to where it parts again.
    pub(super) fn contact(&self, motion: &Motion, phase: &Phase, met: Met, budget: &mut Budget<'_>) -> ContactReport {
        let (mut q, mut X_WJ) = (Vec::new(), Vec::new());
        let margin = phase.pairs.margin(met.pair);
        let mut deepest: Option<(f64, f64)> = None;
        let (mut until, mut least) = (met.at, (met.distance, met.at));
        let mut is_contained = false;
        for place in self.places_behind(motion, phase, met.at) {
            self.poses(motion, phase, place, &mut q, &mut X_WJ);
            budget.spent += 1;
            let ask = Ask { absolute: 1e-9, ..Ask::exact(margin) };
            let distance = pair_clearance(&self.scene, met.pair, &X_WJ, ask, &mut DVec3::ZERO.clone());
            let inside = contained(&self.scene, met.pair, &X_WJ);
            if (distance > margin && !inside && place > met.at) || !(budget.go_on)() {
                break;
            }
            until = place;
            is_contained |= inside;
            if distance < least.0 {
                least = (distance, place);
            }
            let found = self.depth(met.pair, &X_WJ);
            if let Some(found) = found.filter(|found| deepest.is_none_or(|(depth, _)| *found > depth)) {
                deepest = Some((found, place));
            }
        }
        let distance = if least.0.is_finite() { least.0 } else { 0.0 };
        ContactReport {
            at: motion.time(met.at),
            pair: self.pair_name(met.pair),
            margin,
            depth: deepest.map(|(depth, _)| depth),
            deepest_at: motion.time(deepest.map_or(least.1, |(_, at)| at)),
            least_distance: deepest.map_or(distance, |(depth, _)| distance.min(-depth)),
            contained: is_contained,
            until: motion.time(until),
        }
    }

    /// From a place on, close together first.
    fn places_behind(&self, motion: &Motion, phase: &Phase, from: f64) -> Vec<f64> {
        let end = phase.to.min(motion.segments.len() as f64);
        let place = |i: u32| from + (end - from) * (f64::from(i) / f64::from(PLACES)).powi(3);
        let mut places: Vec<f64> = (0..=PLACES).map(place).collect();
        places.dedup();
        places
    }

    fn depth(&self, pair: PairId, X_WJ: &[Pose]) -> Option<f64> {
        let pair = &self.scene.pairs()[pair.at()];
        let placed = |shape: foliate_components::robot::ShapeIndex| {
            let solid = &self.scene.solids()[shape.at()];
            let pose = solid.body.map_or(Pose::identity(), |b| X_WJ[b.at()]) * solid.X_JS;
            Placed { geometry: &self.robot().shapes[shape.at()].geometry, solid: &solid.solid, pose }
        };
        depth(placed(pair.first), placed(pair.second))
    }
}
