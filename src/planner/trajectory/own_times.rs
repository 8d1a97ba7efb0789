//! Times for a path that has none: a unit of length takes a second.

use crate::planner::trajectory::curve::Interpolation;
use foliate_components::path::{ManipulationPath, SegmentTiming};
use foliate_components::robot::Robot;
use foliate_components::robot::configuration::{ConfigurationSpace, Group};

/// A path with times, its own or made up.
#[derive(Clone, Debug)]
pub struct TimedMotion {
    /// The path, with times.
    pub path: ManipulationPath,
    /// Between its knots.
    pub interpolation: Interpolation,
    /// Whether the times are the path's own.
    pub is_own: bool,
}

impl TimedMotion {
    /// The path as it is where it has times. Without them it is straight from knot to knot, and the length of the way in the joints' space
    /// (radians and metres alike) is its time.
    #[must_use]
    pub fn new(robot: &Robot, path: &ManipulationPath, interpolation: Interpolation) -> Self {
        let mut path = path.clone();
        if path.segments.iter().all(|segment| segment.timing.is_some()) {
            return Self { path, interpolation, is_own: true };
        }
        let mut now = 0.0;
        for segment in &mut path.segments {
            let mut times = Vec::with_capacity(segment.knots.len());
            for (number, knot) in segment.knots.iter().enumerate() {
                if let Some(before) = number.checked_sub(1) {
                    now += length(&robot.space, &segment.knots[before], knot);
                }
                times.push(now);
            }
            segment.timing = Some(SegmentTiming { times, velocities: Vec::new() });
        }
        Self { path, interpolation: Interpolation::Linear, is_own: false }
    }
}

/// The length of a straight way, number by number: an angle that turns by 2π has gone all the way round.
fn length(space: &ConfigurationSpace, from: &[f64], to: &[f64]) -> f64 {
    let mut weights = vec![1.0; space.dimension()];
    let mut turned = 0.0;
    for factor in &space.factors {
        // The distance of the space takes the shorter way round; these angles are counted here.
        let angle = match factor.group {
            Group::Circle => 0,
            Group::Plane => 2,
            Group::Real | Group::FreeFlyer => continue,
        };
        weights[factor.v + angle] = 0.0;
        turned += (to[factor.q + angle] - from[factor.q + angle]).powi(2);
    }
    (space.distance(from, to, &weights).powi(2) + turned).sqrt()
}
