//! What a path costs.

/// What is minimised: the duration of the timed path, or its length, plus a charge for every grasp and release.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostOptions {
    /// What a motion costs.
    pub motion: MotionCost,
    /// Charge for every grasp and every release, in the unit of the motion's cost (seconds or metres).
    pub grasp_charge: f64,
}

/// What a motion costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MotionCost {
    /// Seconds, under the limits of velocity and acceleration.
    #[default]
    Duration,
    /// Weighted length, metres.
    Length,
}

impl Default for CostOptions {
    fn default() -> Self {
        Self { motion: MotionCost::Duration, grasp_charge: 2.0 }
    }
}
