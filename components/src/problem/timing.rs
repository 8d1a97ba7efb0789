//! How fast joints may move, and how long hands take.

use crate::robot::indices::{JointIndex, PartIndex};

/// How a path is timed. The defaults apply to joints of which the model says nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct TimingOptions {
    /// Velocity limits of the models, and the defaults where they have none, times this; above 0 and at most 1.
    pub velocity_scale: f64,
    /// Velocity limits in place of the models'; they are not scaled. Of several for one number the last counts.
    pub velocity: Vec<NumberLimit>,
    /// Acceleration limits. Without one a joint may reach its velocity limit within [`Self::ramp`] seconds. Of several for one number
    /// the last counts.
    pub acceleration: Vec<NumberLimit>,
    /// Seconds within which a joint reaches its velocity limit where no acceleration limit is given; above 0.
    pub ramp: f64,
    /// Jerk limits of all joints: seconds within which a joint reaches its acceleration limit. 0 for no limit.
    pub jerk_ramp: f64,
    /// How fast the origin of an object's root link may move while a gripper holds the object, m/s, above 0.
    pub object_speed: Vec<(PartIndex, f64)>,
    /// How long the robot stands still at every grasp and every release, seconds.
    pub dwell: f64,
}

/// A limit of one of a joint's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberLimit {
    /// The joint. It may follow another one.
    pub joint: JointIndex,
    /// Which of its numbers in a configuration: 0 where it has one; 0, 1, 2 for x, y, theta of a planar joint; 0 … 6 for x, y, z, qx, qy, qz,
    /// qw of a free-flyer.
    pub number: usize,
    /// rad/s or m/s (1/s for the numbers of a quaternion); of acceleration the same per second. Above 0.
    pub limit: f64,
}

impl Default for TimingOptions {
    fn default() -> Self {
        Self {
            velocity_scale: 1.0,
            velocity: Vec::new(),
            acceleration: Vec::new(),
            ramp: 0.5,
            jerk_ramp: 0.0,
            object_speed: Vec::new(),
            dwell: 0.2,
        }
    }
}

/// Velocity limit of a revolute joint whose model has none, rad/s.
pub const TURN_LIMIT: f64 = 1.0;
/// Velocity limit of a prismatic joint, or of a root's position, whose model has none, m/s.
pub const SHIFT_LIMIT: f64 = 0.5;
