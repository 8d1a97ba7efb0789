//! What is said about a contact: how deep, and how long.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::certify::motion::piecewise::Motion;
use crate::certify::proof::advance::{Budget, Met};
use crate::certify::world::phases::{Certifier, Phase};
use crate::certify::world::report::ContactReport;
use foliate_components::Pose;
use foliate_kernels::collision::depth::{PlacedSolid, depth};
use foliate_kernels::collision::{DistanceQuery, PairId, contained, pair_clearance};
use glam::DVec3;

/// Places behind a contact at which the pair is measured.
const PLACES: u32 = 256;
/// Places of the contact at which its depth is found.
const DEPTHS: u32 = 16;
/// How often the deepest place is narrowed down.
const NARROWINGS: u32 = 6;

/// What is seen of a pair in contact.
struct Seen {
    until: f64,
    /// The least distance, metres, and where.
    least: (f64, f64),
    contained: bool,
}

impl Certifier {
    /// Follows a pair from where it meets to where it parts again.
    pub(crate) fn contact(&self, motion: &Motion, phase: &Phase, met: Met, budget: &mut Budget<'_>) -> ContactReport {
        let margin = phase.pairs.margin(met.pair);
        let seen = self.follow(motion, phase, met, budget);
        let deepest = self.deepest(motion, phase, met, seen.until, budget);
        let distance = if seen.least.0.is_finite() { seen.least.0 } else { 0.0 };
        ContactReport {
            at: motion.time(met.at),
            pair: self.pair_name(met.pair),
            margin,
            depth: deepest.map(|(depth, _)| depth),
            deepest_at: motion.time(deepest.map_or(seen.least.1, |(_, at)| at)),
            least_distance: deepest.map_or(distance, |(depth, _)| distance.min(-depth)),
            contained: seen.contained,
            until: motion.time(seen.until),
        }
    }

    fn follow(&self, motion: &Motion, phase: &Phase, met: Met, budget: &mut Budget<'_>) -> Seen {
        let (mut q, mut X_WJ) = (Vec::new(), Vec::new());
        let margin = phase.pairs.margin(met.pair);
        let mut seen = Seen { until: met.at, least: (met.distance, met.at), contained: false };
        for place in self.places_behind(motion, phase, met.at) {
            self.poses(motion, phase, place, &mut q, &mut X_WJ);
            budget.spent += 1;
            let ask = DistanceQuery { absolute: 1e-9, ..DistanceQuery::exact(margin) };
            let distance = pair_clearance(&self.scene, met.pair, &X_WJ, ask, &mut DVec3::ZERO.clone());
            let inside = contained(&self.scene, met.pair, &X_WJ);
            if (distance > margin && !inside && place > met.at) || !(budget.go_on)() {
                break;
            }
            seen.until = place;
            seen.contained |= inside;
            if distance < seen.least.0 {
                seen.least = (distance, place);
            }
        }
        seen
    }

    /// The largest depth between two places, and where it is.
    fn deepest(
        &self,
        motion: &Motion,
        phase: &Phase,
        met: Met,
        until: f64,
        budget: &mut Budget<'_>,
    ) -> Option<(f64, f64)> {
        let (mut q, mut X_WJ) = (Vec::new(), Vec::new());
        let mut depth = |place: f64| {
            self.poses(motion, phase, place, &mut q, &mut X_WJ);
            budget.spent += 1;
            (self.depth(met.pair, &X_WJ), place)
        };
        let deeper = |a: (Option<f64>, f64), b: (Option<f64>, f64)| if b.0 > a.0 { b } else { a };
        let step = (until - met.at) / f64::from(DEPTHS);
        let places = (0..=DEPTHS).map(|i| met.at + step * f64::from(i));
        let mut best = places.map(&mut depth).reduce(deeper)?;
        let mut by = 0.5 * step;
        for _ in 0..NARROWINGS {
            let around = [(best.1 - by).max(met.at), (best.1 + by).min(until)];
            best = around.into_iter().map(&mut depth).fold(best, deeper);
            by *= 0.5;
        }
        best.0.map(|depth| (depth, best.1))
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
            PlacedSolid { geometry: &self.robot().shapes[shape.at()].geometry, solid: &solid.solid, pose }
        };
        depth(placed(pair.first), placed(pair.second))
    }
}
