//! What a path costs: the motions between two stops, and the grasps and releases.

use crate::improvement::leaf_motion::{LeafMotion, grasp_changes};
use crate::planning_model::model::Model;
use foliate_components::problem::cost::MotionCost;
use foliate_components::problem::{Problem, RateLimits};
use foliate_components::robot::Source;
use std::fmt;

/// What is minimised: every motion from a stop to the next has a cost that grows with its way, and every grasp and release has one.
pub trait PathCost: fmt::Debug + Send + Sync {
    /// For output.
    fn name(&self) -> &'static str;

    /// The way from one whole configuration to another along the straight line: a distance. It is never negative, and a detour is
    /// not shorter.
    fn way(&self, model: &Model, a: &[f64], b: &[f64]) -> f64;

    /// Cost of a motion of this way from a stop to the next. It never falls where the way grows.
    fn motion(&self, way: f64) -> f64;

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
    let (mut sum, mut way) = (0.0, 0.0);
    for (index, motion) in motions.iter().enumerate() {
        way += way_along(cost, model, motion.knots.chunks_exact(size));
        let next = motions.get(index + 1);
        if next.is_none_or(|next| !motion.is_on_leaf_of(next)) {
            sum += cost.motion(way);
            way = 0.0;
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

    fn motion(&self, way: f64) -> f64 {
        way
    }

    fn grasp_change(&self) -> f64 {
        self.grasp_change
    }
}

/// An estimate of the duration, seconds: how long the motion takes at full speed, and what it loses while it speeds up and slows down
/// at its stops. Corners are taken to be rounded without loss.
#[derive(Clone, Debug, PartialEq)]
pub struct Duration {
    /// By coordinate: 1 / velocity limit; 0 for movable objects, which follow what carries them.
    slowness: Vec<f64>,
    /// How long the slowest joint takes to reach its full speed, seconds.
    ramp: f64,
    grasp_change: f64,
}

/// How much all joints count beside the slowest one. Without it a detour of the others would be free.
const OTHERS: f64 = 0.02;

impl Duration {
    /// Under the limits of a problem.
    #[must_use]
    pub fn of(problem: &Problem) -> Self {
        let limits = RateLimits::of(&problem.robot, &problem.timing);
        let mut slowness: Vec<f64> = limits.velocity.iter().map(|v| 1.0 / v).collect();
        for object in &problem.graph.objects {
            let root = problem.robot.parts[object.part.at()].root_joint;
            if let Some(Source::Coordinates { q, .. }) = root.map(|root| problem.robot.joints[root.at()].source) {
                slowness[q..q + 7].fill(0.0);
            }
        }
        let ramps = limits.velocity.iter().zip(&limits.acceleration).zip(&slowness);
        let ramp = ramps.filter(|(_, slowness)| **slowness > 0.0).map(|((v, a), _)| v / a).fold(0.0, f64::max);
        Self { slowness, ramp, grasp_change: problem.cost.grasp_charge + problem.timing.dwell }
    }
}

impl PathCost for Duration {
    fn name(&self) -> &'static str {
        "duration"
    }

    /// Seconds at full speed.
    fn way(&self, _: &Model, a: &[f64], b: &[f64]) -> f64 {
        let (mut largest, mut sum) = (0.0_f64, 0.0);
        for ((x, y), slowness) in a.iter().zip(b).zip(&self.slowness) {
            let time = (y - x).abs() * slowness;
            largest = largest.max(time);
            sum += time;
        }
        largest + OTHERS * sum
    }

    fn motion(&self, way: f64) -> f64 {
        if way >= self.ramp { way + self.ramp } else { 2.0 * (way * self.ramp).sqrt() }
    }

    fn grasp_change(&self) -> f64 {
        self.grasp_change
    }
}
