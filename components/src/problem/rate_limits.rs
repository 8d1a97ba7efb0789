//! Limits of velocity, acceleration and jerk, by coordinate.

use crate::problem::timing::{SHIFT_LIMIT, TURN_LIMIT, TimingOptions};
use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::JointIndex;
use crate::robot::joint::{JointType, Source};

/// Limits of the rates of every coordinate of a configuration. An infinite limit is none.
///
/// They apply to coordinates as numbers: of a free-flyer to each of its three positions (m/s) and to each of the four numbers of its
/// quaternion before it is scaled to length 1 (1/s; half an angular velocity in rad/s).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RateLimits {
    /// By coordinate: rad/s or m/s.
    pub velocity: Vec<f64>,
    /// By coordinate: rad/s² or m/s².
    pub acceleration: Vec<f64>,
    /// By coordinate: rad/s³ or m/s³.
    pub jerk: Vec<f64>,
}

impl RateLimits {
    /// The limits of a robot's coordinates. Joints that follow a leader narrow its limits.
    #[must_use]
    pub fn of(robot: &Robot, options: &TimingOptions) -> Self {
        let size = robot.space.size();
        let unlimited = || vec![f64::INFINITY; size];
        let mut limits = Self { velocity: unlimited(), acceleration: unlimited(), jerk: unlimited() };
        for (index, joint) in robot.joints.iter().enumerate() {
            let index = JointIndex(index as u32);
            let given = |list: &[(JointIndex, f64)]| list.iter().rev().find(|(j, _)| *j == index).map(|(_, l)| *l);
            let own = given(&options.velocity)
                .or_else(|| joint.velocity_limit.filter(|l| *l > 0.0).map(|l| l * options.velocity_scale));
            let (q, share) = match joint.source {
                Source::Coordinates { q, .. } => (q, 1.0),
                Source::Follows { leader, multiplier, .. } => match robot.joints[leader.at()].source {
                    Source::Coordinates { q, .. } if multiplier != 0.0 => (q, 1.0 / multiplier.abs()),
                    _ => continue,
                },
            };
            for number in 0..joint.motion.configuration_size() {
                let usual = match (joint.motion, number) {
                    (JointType::Revolute { .. }, _) | (JointType::Planar, 2) => TURN_LIMIT,
                    (JointType::FreeFlyer, 3..) => 0.5 * TURN_LIMIT,
                    _ => SHIFT_LIMIT,
                };
                let follows = matches!(joint.source, Source::Follows { .. });
                if follows && own.is_none() {
                    continue;
                }
                let velocity = own.unwrap_or(usual * options.velocity_scale);
                let acceleration = given(&options.acceleration).unwrap_or(velocity / options.ramp);
                let jerk = if options.jerk_ramp > 0.0 { acceleration / options.jerk_ramp } else { f64::INFINITY };
                let narrow = |limit: &mut f64, to: f64| *limit = limit.min(to * share);
                narrow(&mut limits.velocity[q + number], velocity);
                narrow(&mut limits.acceleration[q + number], acceleration);
                narrow(&mut limits.jerk[q + number], jerk);
            }
        }
        limits
    }
}
