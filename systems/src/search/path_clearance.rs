//! The least clearance along a path, and its pair.
//!
//! What counts is the path as it is written: between two knots objects follow what carries them from where the first knot of
//! the segment has them, and at the end everything is where the last knot has it. A segment with times is the curve that these
//! make of it, another one is straight from knot to knot. A checker of the path file finds the same motion, and so no pair closer
//! than this.

use crate::planning_model::model::Model;
use crate::search::segment_leaf::attachments_as_written;
use crate::search::timed_rows::TimedRows;
use foliate_components::coverage::PairCounts;
use foliate_components::path::{ManipulationPath, Segment};
use foliate_components::robot::{LinkIndex, ShapeIndex};
use foliate_kernels::collision::{
    CollisionScratch, MinimumClearance, MinimumSettings, minimum_clearance_along, minimum_clearance_on_curve,
};
use std::collections::HashSet;

/// The least clearance along a path: of all tested pairs of shapes, moving or not, the distance less the margin that holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathClearance {
    /// No pair comes closer than this anywhere, metres; proved over the continuum. At least 90 % of the least clearance or
    /// 0.1 mm below it, whichever is less, and never below half of it.
    pub lower: f64,
    /// Where the closest pair is, to within the same.
    pub nearest: Option<NearestOnPath>,
}

/// A pair at a place of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestOnPath {
    /// The two shapes.
    pub shapes: (ShapeIndex, ShapeIndex),
    /// Number of the segment, from 0.
    pub segment: usize,
    /// The piece of the segment, from 0, and how far along it, added up: 1.5 is half way between its second and third knot.
    pub t: f64,
    /// Its clearance there is at most this, metres.
    pub clearance: f64,
}

/// The least clearance along a path of the model's problem; `None` where no pair of shapes is tested, so that nothing is
/// said. The same path gives the same answer.
///
/// # Panics
/// If the path is not one of the model's: its ids and its knots' lengths.
#[must_use]
pub fn path_clearance(model: &Model, path: &ManipulationPath) -> Option<PathClearance> {
    if model.collision.counts().looked_at() == 0 {
        return None;
    }
    let mut scratch = CollisionScratch::new();
    let mut least = PathClearance { lower: f64::INFINITY, nearest: None };
    // Where a motion begins and anywhere along it each row of a relative pose is off by no more than the largest residual:
    // three rows make a vector, and the difference of two is looked for.
    let rigid_within = 4.0 * path.certificate.max_residual;
    let minimum = MinimumSettings { rigid_within, ..MinimumSettings::default() };
    for (number, segment) in path.segments.iter().enumerate() {
        let below = least.nearest.map_or(minimum.below, |nearest| nearest.clearance);
        let minimum = MinimumSettings { below, ..minimum };
        least.take(model, number, 0.0, along(model, segment, &minimum, &mut scratch));
    }
    if let Some((number, segment)) = path.segments.iter().enumerate().next_back() {
        let below = least.nearest.map_or(minimum.below, |nearest| nearest.clearance);
        let minimum = MinimumSettings { below, ..minimum };
        let end = segment.knots.len() - 1;
        let found = as_written(model, segment, &segment.knots[end], &minimum, &mut scratch);
        least.take(model, number, end as f64, found);
    }
    Some(least)
}

impl PathClearance {
    /// Adds what was found of a segment whose parameters begin at `from`.
    fn take(&mut self, model: &Model, segment: usize, from: f64, found: MinimumClearance) {
        self.lower = self.lower.min(found.lower);
        if let Some(nearest) = found.nearest {
            let shapes = model.pair_shapes(nearest.pair);
            let (t, clearance) = (from + nearest.t, nearest.clearance);
            self.nearest = Some(NearestOnPath { shapes, segment, t, clearance });
        }
    }
}

/// A segment's motion.
fn along(
    model: &Model,
    segment: &Segment,
    minimum: &MinimumSettings,
    scratch: &mut CollisionScratch,
) -> MinimumClearance {
    let rigid_attachments = attachments_as_written(model, segment);
    let pairs = model.pairs_with_margins(segment.transition, segment.state, &rigid_attachments);
    let (scene, kinematics) = (&model.collision, &model.kinematics);
    match TimedRows::of(segment) {
        None => minimum_clearance_along(
            scene,
            kinematics,
            &rigid_attachments,
            &segment.knots.concat(),
            &pairs,
            minimum,
            scratch,
        ),
        Some(rows) => {
            let curve = rows.curve();
            minimum_clearance_on_curve(scene, kinematics, &rigid_attachments, &curve, &pairs, minimum, scratch)
        }
    }
}

/// A knot, with objects where it has them.
fn as_written(
    model: &Model,
    segment: &Segment,
    knot: &[f64],
    minimum: &MinimumSettings,
    scratch: &mut CollisionScratch,
) -> MinimumClearance {
    let pairs = model.pairs_with_margins(segment.transition, segment.state, &attachments_as_written(model, segment));
    minimum_clearance_along(&model.collision, &model.kinematics, &[], knot, &pairs, minimum, scratch)
}

/// Which pairs of shapes were tested for a path, and which were left out.
#[must_use]
pub(crate) fn pair_counts(model: &Model, path: &ManipulationPath) -> PairCounts {
    let mut counts = model.collision.counts();
    if model.problem.margins.is_empty() {
        return counts;
    }
    let (mut grasped, mut placed) = (HashSet::new(), HashSet::new());
    let transitions: HashSet<_> = path.segments.iter().map(|segment| segment.transition).collect();
    for transition in transitions {
        let touches = model.touches_along(transition);
        let ordered = |(a, b): (LinkIndex, LinkIndex)| (a.min(b), a.max(b));
        grasped.extend(touches.grasped.into_iter().map(ordered));
        placed.extend(touches.placed.into_iter().map(ordered));
    }
    let link = |shape: ShapeIndex| model.problem.robot.shapes[shape.at()].link;
    for pair in model.collision.pairs().iter().filter(|pair| pair.margin > 0.0) {
        let (a, b) = (link(pair.first), link(pair.second));
        let links = (a.min(b), a.max(b));
        counts.grasped += u64::from(grasped.contains(&links));
        counts.placed += u64::from(placed.contains(&links));
    }
    counts
}
