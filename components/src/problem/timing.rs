//! How fast joints may move, and how long hands take.

use crate::robot::indices::JointIndex;

/// How a path is timed. The defaults apply to joints of which the model says nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct TimingOptions {
    /// Velocity limits of the models times this, above 0 and at most 1.
    pub velocity_scale: f64,
    /// Velocity limits in place of the models': rad/s or m/s.
    pub velocity: Vec<(JointIndex, f64)>,
    /// Acceleration limits, rad/s² or m/s². Without one a joint may reach its velocity limit within [`Self::ramp`] seconds.
    pub acceleration: Vec<(JointIndex, f64)>,
    /// Seconds within which a joint reaches its velocity limit where no acceleration limit is given.
    pub ramp: f64,
    /// Jerk limits, rad/s³ or m/s³, of all joints: seconds within which a joint reaches its acceleration limit. 0 for no limit.
    pub jerk_ramp: f64,
    /// How long the robot stands still at every grasp and every release, seconds.
    pub dwell: f64,
}

impl Default for TimingOptions {
    fn default() -> Self {
        Self {
            velocity_scale: 1.0,
            velocity: Vec::new(),
            acceleration: Vec::new(),
            ramp: 0.5,
            jerk_ramp: 0.0,
            dwell: 0.2,
        }
    }
}

/// Velocity limit of a revolute joint whose model has none, rad/s.
pub const TURN_LIMIT: f64 = 1.0;
/// Velocity limit of a prismatic joint, or of a root's position, whose model has none, m/s.
pub const SHIFT_LIMIT: f64 = 0.5;
