//! What a path costs: the motions between two stops, and the grasps and releases.

use crate::improvement::leaf_motion::{LeafMotion, grasp_changes};
use crate::planning_model::model::Model;
use foliate_components::problem::cost::MotionCost;
use foliate_components::problem::{Problem, RateLimits};
use foliate_components::robot::Source;
use std::fmt;

/// What is minimised: the sum of the costs of all motions from a stop to the next, and of all grasps and releases.
pub trait PathCost: fmt::Debug + Send + Sync {
    /// For output.
    fn name(&self) -> &'static str;

    /// The way from one whole configuration to another along the straight line: a distance. It is never negative, and a detour is
    /// not shorter.
    fn way(&self, model: &Model, a: &[f64], b: &[f64]) -> f64;

    /// Cost of a motion from a stop to the next along straight lines from knot to knot; at least one.
    fn motion(&self, model: &Model, knots: &[&[f64]]) -> f64;

    /// Cost of a grasp or a release.
    fn grasp_change(&self) -> f64;
}

/// The cost that a problem asks for.
#[must_use]
pub fn shipped(problem: &Problem) -> Box<dyn PathCost> {
    match problem.cost.motion {
        MotionCost::Length => Box::new(Length { grasp_change: problem.cost.grasp_charge }),
        _ => Box::new(Duration::of(problem)),
    }
}

/// The cost of a path: motions from stop to stop, and grasp changes between them.
#[must_use]
pub fn path_cost(cost: &dyn PathCost, model: &Model, motions: &[LeafMotion]) -> f64 {
    let size = model.problem.robot.space.size();
    let mut sum = 0.0;
    let mut knots: Vec<&[f64]> = Vec::new();
    for (index, motion) in motions.iter().enumerate() {
        // Motions of one stretch share their joint knots.
        let shared = usize::from(!knots.is_empty());
        knots.extend(motion.knots.chunks_exact(size).skip(shared));
        let next = motions.get(index + 1);
        if next.is_none_or(|next| !motion.is_on_leaf_of(next)) {
            sum += cost.motion(model, &knots);
            knots.clear();
        }
        sum += next.map_or(0.0, |next| grasp_changes(model, motion, next) as f64 * cost.grasp_change());
    }
    sum
}

/// The way along some configurations.
#[must_use]
pub fn way_along<'k>(cost: &dyn PathCost, model: &Model, knots: impl IntoIterator<Item = &'k [f64]>) -> f64 {
    let mut knots = knots.into_iter();
    let Some(mut last) = knots.next() else { return 0.0 };
    let mut way = 0.0;
    for knot in knots {
        way += cost.way(model, last, knot);
        last = knot;
    }
    way
}

/// Weighted length, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// Charge for a grasp or release, metres.
    pub grasp_change: f64,
}

impl PathCost for Length {
    fn name(&self) -> &'static str {
        "length"
    }

    fn way(&self, model: &Model, a: &[f64], b: &[f64]) -> f64 {
        model.problem.robot.space.distance(a, b, &model.robot_weights)
    }

    fn motion(&self, model: &Model, knots: &[&[f64]]) -> f64 {
        way_along(self, model, knots.iter().copied())
    }

    fn grasp_change(&self) -> f64 {
        self.grasp_change
    }
}

/// An estimate of the duration, seconds: the fastest motion along the polyline whose corners are replaced by arcs as long as the edges
/// allow. At an arc of radius r from direction d₀ to d₁ the speed s′ along the path keeps s′² |d₁ − d₀| ≤ 2 r a.
#[derive(Clone, Debug, PartialEq)]
pub struct Duration {
    /// By coordinate: 1 / velocity limit; 0 for movable objects, which follow what carries them.
    slowness: Vec<f64>,
    /// By coordinate: 1 / acceleration limit; 0 likewise.
    sluggishness: Vec<f64>,
    grasp_change: f64,
}

/// How much all joints count beside the slowest one. Without it a detour of the others would be free.
const OTHERS: f64 = 0.02;

/// Edges that are shorter have no direction, seconds at full speed.
const SHORTEST: f64 = 1e-6;

impl Duration {
    /// Under the limits of a problem.
    #[must_use]
    pub fn of(problem: &Problem) -> Self {
        let limits = RateLimits::of(&problem.robot, &problem.timing);
        let inverse = |limits: &[f64]| -> Vec<f64> { limits.iter().map(|limit| 1.0 / limit).collect() };
        let (mut slowness, mut sluggishness) = (inverse(&limits.velocity), inverse(&limits.acceleration));
        for object in &problem.graph.objects {
            let root = problem.robot.parts[object.part.at()].root_joint;
            if let Some(Source::Coordinates { q, .. }) = root.map(|root| problem.robot.joints[root.at()].source) {
                slowness[q..q + 7].fill(0.0);
                sluggishness[q..q + 7].fill(0.0);
            }
        }
        Self { slowness, sluggishness, grasp_change: problem.cost.grasp_charge + problem.timing.dwell }
    }

    /// At full speed from one configuration to another, seconds; and the sum of all coordinates' times.
    fn at_full_speed(&self, a: &[f64], b: &[f64]) -> (f64, f64) {
        let (mut largest, mut sum) = (0.0_f64, 0.0);
        for ((x, y), slowness) in a.iter().zip(b).zip(&self.slowness) {
            let time = (y - x).abs() * slowness;
            largest = largest.max(time);
            sum += time;
        }
        (largest, sum)
    }

    /// The edges of a polyline, and the largest squared speed at the beginning of each.
    fn edges(&self, knots: &[&[f64]]) -> Vec<Edge> {
        let mut edges: Vec<Edge> = Vec::with_capacity(knots.len());
        let mut last: Option<(&[f64], &[f64])> = None;
        let mut from = knots[0];
        for &to in &knots[1..] {
            let (length, others) = self.at_full_speed(from, to);
            if length < SHORTEST {
                continue;
            }
            let most = |i: usize| (to[i] - from[i]).abs() / length * self.sluggishness[i];
            let acceleration = 1.0 / (0..to.len()).map(most).fold(f64::MIN_POSITIVE, f64::max);
            let turn = last.zip(edges.last()).map_or(f64::INFINITY, |((a, b), before)| {
                let by = |i: usize| ((to[i] - from[i]) / length - (b[i] - a[i]) / before.length).abs();
                (0..to.len()).map(|i| by(i) * self.sluggishness[i]).fold(0.0, f64::max)
            });
            let radius = edges.last().map_or(0.0, |before| 0.5 * before.length.min(length));
            edges.push(Edge { length, others, acceleration, entry: (2.0 * radius / turn).min(1.0) });
            last = Some((from, to));
            from = to;
        }
        edges
    }
}

/// A straight piece of a path; lengths are seconds at full speed.
struct Edge {
    length: f64,
    /// Sum of all coordinates' times.
    others: f64,
    /// How fast the speed along the path may change.
    acceleration: f64,
    /// Squared speed at the beginning.
    entry: f64,
}

impl Edge {
    /// How long it takes with squared speeds at its ends.
    fn time(&self, entry: f64, exit: f64) -> f64 {
        let a = self.acceleration;
        let peak = (0.5 * (entry + exit) + a * self.length).min(1.0);
        let ramps = (2.0 * peak.sqrt() - entry.sqrt() - exit.sqrt()) / a;
        let cruise = self.length - (2.0 * peak - entry - exit) / (2.0 * a);
        ramps + cruise.max(0.0) / peak.sqrt()
    }
}

impl PathCost for Duration {
    fn name(&self) -> &'static str {
        "duration"
    }

    /// Seconds at full speed.
    fn way(&self, _: &Model, a: &[f64], b: &[f64]) -> f64 {
        let (largest, sum) = self.at_full_speed(a, b);
        largest + OTHERS * sum
    }

    fn motion(&self, _: &Model, knots: &[&[f64]]) -> f64 {
        let mut edges = self.edges(knots);
        for index in (0..edges.len().saturating_sub(1)).rev() {
            let next = edges[index + 1].entry;
            let edge = &mut edges[index];
            edge.entry = edge.entry.min(next + 2.0 * edge.acceleration * edge.length);
        }
        let mut time = 0.0;
        let mut entry = 0.0_f64;
        for (index, edge) in edges.iter().enumerate() {
            let exit = edges.get(index + 1).map_or(0.0, |next| next.entry);
            let exit = exit.min(entry + 2.0 * edge.acceleration * edge.length);
            time += edge.time(entry, exit) + OTHERS * edge.others;
            entry = exit;
        }
        time
    }

    fn grasp_change(&self) -> f64 {
        self.grasp_change
    }
}
