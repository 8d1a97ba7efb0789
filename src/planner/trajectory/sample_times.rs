//! Times at a rate, from the first to the last moment of a trajectory.

use crate::planner::trajectory::error::TrajectoryError;

/// Most samples of one trajectory.
const SAMPLES: f64 = 1e7;

/// Times at a rate: the start, then one every 1/rate seconds, and last exactly the end.
#[derive(Clone, Debug)]
pub struct SampleTimes {
    start: f64,
    end: f64,
    rate: f64,
    next: usize,
    /// Number of the last one.
    last: usize,
}

impl SampleTimes {
    /// A time that is closer to the end than a millionth of a step is the end.
    pub(super) fn new(start: f64, end: f64, rate: f64) -> Result<Self, TrajectoryError> {
        let steps = ((end - start) * rate - 1e-6).ceil().max(0.0);
        let is_rate = rate > 0.0 && rate.is_finite() && steps < SAMPLES;
        if is_rate {
            Ok(Self { start, end, rate, next: 0, last: steps as usize })
        } else {
            Err(TrajectoryError::Rate(rate))
        }
    }
}

impl Iterator for SampleTimes {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        let number = self.next;
        if number > self.last {
            return None;
        }
        self.next += 1;
        Some(if number == self.last { self.end } else { self.start + number as f64 / self.rate })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.last + 1 - self.next;
        (left, Some(left))
    }
}

impl ExactSizeIterator for SampleTimes {}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(end: f64, rate: f64) -> Vec<f64> {
        SampleTimes::new(0.0, end, rate).expect("a rate").collect()
    }

    #[test]
    fn the_last_time_is_the_end_and_no_step_is_too_long() {
        assert_eq!(times(0.03, 100.0), [0.0, 0.01, 0.02, 0.03]);
        assert_eq!(times(0.025, 100.0), [0.0, 0.01, 0.02, 0.025]);
        // Rounding makes no step of a billionth.
        assert_eq!(times(0.1 + 0.2, 10.0).len(), 4);
        assert_eq!(times(0.0, 100.0), [0.0]);
        assert_eq!(times(1e-9, 100.0), [1e-9]);
    }

    #[test]
    fn what_is_no_rate_is_refused() {
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(SampleTimes::new(0.0, 1.0, rate).is_err(), "{rate}");
        }
    }
}
