//! The coordinates that have limits and move.

use crate::trajectory::peak_rates::Limits;
use crate::trajectory::spline::Spline;
use crate::trajectory::time_optimal::error::TimingError;

/// The coordinates that have limits and move.
#[derive(Clone, Debug, Default)]
pub(super) struct Counted {
    pub coordinates: Vec<usize>,
    /// 1 / limit, 0 where there is none.
    pub by_velocity: Vec<f64>,
    pub by_acceleration: Vec<f64>,
}

impl Counted {
    /// Finds them.
    pub fn find(&mut self, path: &Spline, limits: Limits<'_>) -> Result<(), TimingError> {
        self.coordinates.clear();
        self.by_velocity.clear();
        self.by_acceleration.clear();
        if limits.velocity.len() != path.size() || limits.acceleration.len() != path.size() {
            return Err(TimingError::LimitCount);
        }
        for coordinate in 0..path.size() {
            let [velocity, acceleration] = [limits.velocity[coordinate], limits.acceleration[coordinate]];
            if velocity.is_nan() || acceleration.is_nan() || velocity < 0.0 || acceleration < 0.0 {
                return Err(TimingError::Limit { coordinate });
            }
            let first = path.knot(0)[coordinate];
            let moves = |knot: usize| path.knot(knot)[coordinate] != first || path.velocity(knot)[coordinate] != 0.0;
            if velocity.min(acceleration) == f64::INFINITY || !(0..path.len()).any(moves) {
                continue;
            }
            if velocity == 0.0 || acceleration == 0.0 {
                return Err(TimingError::Immovable { coordinate });
            }
            self.coordinates.push(coordinate);
            self.by_velocity.push(1.0 / velocity);
            self.by_acceleration.push(1.0 / acceleration);
        }
        Ok(())
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.coordinates.len()
    }
}
