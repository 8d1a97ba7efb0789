//! Collision along a segment, proved over the continuum pair by pair.
//!
//! Each pair marches forward (B. Mirtich, Impulse-based dynamic simulation, 1996; conservative advancement): with a
//! distance d beyond the margin at a place, the pair is free until its two solids may have approached each other by d.
//! How much they may is the sum, over the joints between them in the attachment tree, of travel times reach. A pair
//! whose solids do not move against each other is asked once.

use crate::check::clearance::certificate::CLAIM_SLACK;
use crate::check::clearance::enclosure::{Shell, witnesses};
use crate::check::clearance::pairs::Pairs;
use crate::check::distance::measured::{Measured, Placed, at_least, ball_bound, box_bound, exact};
use crate::check::distance::pieces::Hint;
use crate::check::motion::reach::Reach;
use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::kind::Kind;
use crate::check::report::work::Work;
use crate::check::world::models::World;
use glam::DVec3;

/// Rounding, metres: taken off every step forward.
const ROUNDING: f64 = 1e-10;
/// A step over which the solids approach each other by no more than this cannot be told from contact, metres.
const RESOLUTION: f64 = 1e-8;
/// How far ahead of a stand contact is looked for, metres of movement.
const LOOK_AHEAD: f64 = 1e-3;
/// A cheap bound is good enough to march by when it is at least this, metres.
const FAR: f64 = 0.05;

/// What clearances are proved to be at least, beyond margins, where the smallest that was seen is this and the smallest was
/// asked for: a tenth less, or a tenth of a millimetre. Metres.
pub(crate) fn least_between(seen: f64) -> f64 {
    (seen - (0.1 * seen).max(1e-4)).max(0.0)
}

/// Tests the listed pairs along segments.
pub(crate) struct Clearance<'w> {
    world: &'w World,
    pairs: &'w Pairs,
    shapes: Vec<Measured>,
    shells: Vec<Option<Shell<'w>>>,
    witnesses: Vec<Vec<DVec3>>,
    /// Whether the smallest clearance of the path is asked for, and not only whether there is any.
    least: bool,
    /// The smallest clearance that the file claims; proved to a tenth, or a tenth of a millimetre. Metres.
    claim: f64,
}

impl<'w> Clearance<'w> {
    pub(crate) fn new(world: &'w World, pairs: &'w Pairs, least: bool, claim: Option<f64>) -> Self {
        Self {
            world,
            pairs,
            least,
            claim: claim.unwrap_or(0.0),
            shapes: Measured::all(world),
            shells: world.shapes.iter().map(|s| Shell::of(&s.geometry)).collect(),
            witnesses: world.shapes.iter().map(|s| witnesses(&s.geometry)).collect(),
        }
    }

    /// One segment, all pairs.
    pub(crate) fn check(
        &self,
        motion: &SegmentMotion<'_>,
        thresholds: &[f64],
        moving: &mut [bool],
        report: &mut CheckReport,
        work: &mut Work,
    ) {
        let reach = Reach::new(motion);
        for (pair, &threshold) in thresholds.iter().enumerate() {
            let movement = self.movement(motion, &reach, pair);
            moving[pair] |= movement.last().is_some_and(|&moved| moved > 0.0);
            let mut march = March { tester: self, motion, pair, threshold, movement, report, work, hint: None };
            march.go();
            self.enclosed(motion, pair, report);
            if report.is_broken() {
                work.refused();
            }
            if work.is_over() {
                return;
            }
        }
    }

    /// The last knot as written: objects where the file puts them, not where carriers take them.
    pub(crate) fn check_written_end(&self, motion: &SegmentMotion<'_>, thresholds: &[f64], report: &mut CheckReport) {
        let knot = motion.last();
        for (pair, &threshold) in thresholds.iter().enumerate() {
            let placed = |shape: usize| {
                let shape = &self.shapes[shape];
                (shape, shape.in_world(motion.written(shape.body(), knot)))
            };
            let (a, b) = self.pairs.list[pair];
            let (a, b) = (placed(a), placed(b));
            if ball_bound(a, b) > threshold {
                continue;
            }
            self.judge((motion.index, knot as f64), pair, (a, b), threshold, (report, &mut None));
        }
    }

    /// How far the solids of a pair may move against each other, from the first knot to each knot. Where that is more than their balls are
    /// apart, a better bound is worth its search.
    fn movement(&self, motion: &SegmentMotion<'_>, reach: &Reach, pair: usize) -> Vec<f64> {
        let (a, b) = self.pairs.list[pair];
        let (one, other) = (self.shapes[a].end(), self.shapes[b].end());
        let movement = reach.movement(&reach.levers(one, other), motion.knots.len());
        let (a, b) = self.placed(motion, pair, At::knot(0));
        match movement.last() {
            Some(&all) if all > 0.0 && ball_bound(a, b) < all => reach.least_movement(one, other, motion.knots.len()),
            _ => movement,
        }
    }

    fn placed(&self, motion: &SegmentMotion<'_>, pair: usize, at: At) -> (Placed<'_>, Placed<'_>) {
        let place = |shape: usize| {
            let shape = &self.shapes[shape];
            (shape, shape.in_world(motion.pose(shape.body(), at)))
        };
        let (a, b) = self.pairs.list[pair];
        (place(a), place(b))
    }

    fn name(&self, pair: usize) -> String {
        let (a, b) = self.pairs.list[pair];
        format!("{} - {}", self.world.shapes[a].link, self.world.shapes[b].link)
    }

    /// Measures a pair exactly; reports it where it is too close. Returns the distance beyond the threshold.
    fn judge(
        &self,
        (segment, t): (usize, f64),
        pair: usize,
        (a, b): (Placed<'_>, Placed<'_>),
        threshold: f64,
        (report, hint): (&mut CheckReport, &mut Hint),
    ) -> f64 {
        report.counts.distance_queries += 1;
        let found = exact(a, b, hint);
        if let Some(open) = found.open {
            let name = self.name(pair);
            report.note(format!("the distance of {name} is open by {open:.1e} m: the smaller is taken"));
        }
        // Compared so that NaN collides.
        let (free, clear) = (found.value > 0.0, found.value >= threshold);
        if !(free && clear) {
            let (kind, limit) = if free { (Kind::Margin, threshold) } else { (Kind::Collision, 0.0) };
            report.violate(Place::at(segment, t), kind, self.name(pair), found.value, limit);
        }
        report.see_clearance(found.value - threshold, segment, t, || self.name(pair));
        found.value - threshold
    }

    /// Whether one solid of a pair starts inside the other.
    fn enclosed(&self, motion: &SegmentMotion<'_>, pair: usize, report: &mut CheckReport) {
        let (a, b) = self.pairs.list[pair];
        for (outer, inner) in [(a, b), (b, a)] {
            let Some(shell) = &self.shells[outer] else { continue };
            let place = |s: usize| self.shapes[s].in_world(motion.pose(self.shapes[s].body(), At::knot(0)));
            let outer_from_inner = place(outer).inverse() * place(inner);
            if self.witnesses[inner].iter().any(|&p| shell.contains(outer_from_inner.transform_point(p))) {
                let link = |s: usize| &self.world.shapes[s].link;
                let subject = format!("{} inside {}", link(inner), link(outer));
                report.violate(Place::at(motion.index, 0.0), Kind::Enclosed, subject, None, None);
            }
        }
    }
}

/// One pair on its way along a segment.
struct March<'m, 'w> {
    tester: &'m Clearance<'w>,
    motion: &'m SegmentMotion<'m>,
    pair: usize,
    threshold: f64,
    /// How far the solids may have moved against each other, from the first knot to each knot. Metres.
    movement: Vec<f64>,
    report: &'m mut CheckReport,
    work: &'m mut Work,
    /// What was nearest at the last place.
    hint: Hint,
}

impl March<'_, '_> {
    fn go(&mut self) {
        let end = self.movement[self.motion.last()];
        let mut moved = 0.0;
        loop {
            if !self.work.spend(1) {
                return;
            }
            let at = self.place(moved);
            let free = self.free(at, end - moved + self.floor());
            let next = moved + (free - self.floor()) - ROUNDING;
            // Written so that NaN stops here.
            let free_so_far = free > 0.0;
            if !free_so_far || next >= end {
                return;
            }
            if next <= moved + RESOLUTION {
                return self.stalled(moved, at, free);
            }
            moved = next;
        }
    }

    /// What the solids must not come closer than, beyond the margin: what the file claims, nearly, as long as nothing seen
    /// says otherwise; and so much that the smallest clearance that was seen is nearly the smallest that there is, where
    /// that is asked for.
    fn floor(&self) -> f64 {
        let seen = self.report.min_clearance.as_ref().map(|least| least.value);
        let claimed = self.tester.claim;
        let holds = seen.is_none_or(|seen| seen + CLAIM_SLACK >= claimed);
        let claimed = if holds { least_between(claimed) } else { 0.0 };
        seen.filter(|_| self.tester.least).map_or(claimed, |seen| claimed.max(least_between(seen)))
    }

    /// A march comes to a stand just before two solids meet: looks ahead for the place where they have met. Where none
    /// is found they graze each other, closer than can be told.
    fn stalled(&mut self, moved: f64, at: At, free: f64) {
        let end = self.movement[self.motion.last()];
        let mut ahead = RESOLUTION;
        while ahead <= LOOK_AHEAD {
            let place = self.place((moved + ahead).min(end));
            let placed = self.tester.placed(self.motion, self.pair, place);
            let found = self.judge(place, placed);
            let still_free = found > 0.0;
            if !still_free {
                return;
            }
            ahead *= 2.0;
        }
        let place = Place::at(self.motion.index, at.t());
        let name = self.tester.name(self.pair);
        self.report.violate(place, Kind::Undecided, name, free + self.threshold, self.threshold);
    }

    /// How far the solids may approach each other from here without coming too close; at least `enough`, or nearly
    /// exact. Not positive where they are too close, which is then reported.
    fn free(&mut self, at: At, enough: f64) -> f64 {
        let (a, b) = self.tester.placed(self.motion, self.pair, at);
        let good = enough.min(FAR) + ROUNDING;
        let known = self.report.min_clearance.as_ref().map_or(f64::INFINITY, |m| m.value);
        let balls = ball_bound(a, b) - self.threshold;
        if balls > good && balls > known {
            return balls;
        }
        if a.0.is_mesh() || b.0.is_mesh() {
            let boxes = box_bound(a, b) - self.threshold;
            if boxes > good && boxes > known {
                return boxes;
            }
        }
        self.report.counts.distance_queries += 1;
        let wanted = enough.max(if known.is_finite() { known } else { 0.0 }) + 2.0 * ROUNDING;
        let found = at_least(a, b, wanted + self.threshold, &mut self.hint) - self.threshold;
        let surely = found > 0.0 && found > known;
        if surely {
            return found;
        }
        self.judge(at, (a, b))
    }

    fn judge(&mut self, at: At, placed: (Placed<'_>, Placed<'_>)) -> f64 {
        let place = (self.motion.index, at.t());
        self.tester.judge(place, self.pair, placed, self.threshold, (&mut *self.report, &mut self.hint))
    }

    /// Where along the segment the solids have moved this far.
    fn place(&self, moved: f64) -> At {
        let next = self.movement.partition_point(|&m| m <= moved);
        if self.movement.last() == Some(&0.0) {
            return At::knot(0);
        }
        if next == 0 || next >= self.movement.len() {
            return At::knot(self.motion.last());
        }
        let (low, high) = (self.movement[next - 1], self.movement[next]);
        At { knot: next - 1, fraction: ((moved - low) / (high - low)).clamp(0.0, 1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Planner;
    use crate::check::clearance::pairs::Ignored;
    use crate::check::world::{attachments, documents};
    use crate::path_file::document::PathFile;
    use crate::path_file::{PathContext, save, write_path};
    use crate::scene::Scene;
    use crate::scene::sources::package::PackagePath;
    use std::path::Path;

    /// A planned path of the embedded scene, with the models beside it.
    fn planned(folder: &Path) -> PathFile {
        let scene = Scene::load("demo", &PackagePath::only(&[])).unwrap();
        let planner = Planner::new(scene.problem.clone()).unwrap();
        let models = save::model_names(&scene, &folder.join("demo.json")).unwrap();
        let model = planner.model();
        let context = PathContext {
            problem: &model.problem,
            graph: &model.graph,
            models: &models,
            seed: 1,
            scheduler: "mrrt",
            simd: "none",
        };
        write_path(&context, &planner.solve().unwrap().path)
    }

    #[test]
    fn no_two_solids_approach_faster_than_the_bound() {
        let folder = std::env::temp_dir().join(format!("foliate-approach-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = planned(&folder);
        let world = World::load(&file, &folder, &PackagePath::only(&[]), &mut CheckReport::default()).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        let frames = documents::Frames::new(&file, &world).unwrap();
        let attachments = attachments::resolve(&file, &world, &frames).unwrap();
        let pairs = Pairs::list(&file, &world, &Ignored::new(), &mut CheckReport::default(), false).unwrap();
        let tester = Clearance::new(&world, &pairs, false, None);
        let mut tightest = 0.0_f64;
        for (index, segment) in file.segments.iter().enumerate() {
            let motion = SegmentMotion::new(&world, segment, index, &attachments[index]).unwrap();
            let reach = Reach::new(&motion);
            for (pair, &(a, b)) in pairs.list.iter().enumerate() {
                let end = |shape: usize| tester.shapes[shape].end();
                let movement = reach.least_movement(end(a), end(b), motion.knots.len());
                let distance = |at: At| {
                    let (a, b) = tester.placed(&motion, pair, at);
                    exact(a, b, &mut None).value.max(0.0)
                };
                for knot in 0..motion.last() {
                    let places = [0.0, 0.21, 0.5, 0.83, 1.0].map(|fraction| At { knot, fraction });
                    for step in places.windows(2) {
                        let share = step[1].fraction - step[0].fraction;
                        let bound = (movement[knot + 1] - movement[knot]) * share;
                        let change = (distance(step[1]) - distance(step[0])).abs();
                        assert!(change <= bound + 3e-9, "{} in segment {index}: {change} {bound}", tester.name(pair));
                        tightest = tightest.max(change / bound.max(1e-3));
                    }
                }
            }
        }
        assert!(tightest > 0.3, "the bound should not be this loose: {tightest}");
    }
}
