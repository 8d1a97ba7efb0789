//! Limits of velocity, acceleration and jerk, by coordinate.

use crate::problem::timing::{NumberLimit, SHIFT_LIMIT, TURN_LIMIT, TimingOptions};
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
        let unlimited = || vec![f64::INFINITY; robot.space.size()];
        let mut limits = Self { velocity: unlimited(), acceleration: unlimited(), jerk: unlimited() };
        for index in 0..robot.joints.len() {
            let joint = JointIndex(index as u32);
            let Some((first, share)) = moved_by(robot, joint) else { continue };
            for number in 0..robot.joints[index].motion.configuration_size() {
                let (velocity, acceleration) = of_number(robot, joint, number, options);
                let jerk = if options.jerk_ramp > 0.0 { acceleration / options.jerk_ramp } else { f64::INFINITY };
                limits.narrow(first + number, [velocity, acceleration, jerk].map(|limit| limit * share));
            }
        }
        limits
    }

    fn narrow(&mut self, coordinate: usize, to: [f64; 3]) {
        for (limits, to) in [&mut self.velocity, &mut self.acceleration, &mut self.jerk].into_iter().zip(to) {
            limits[coordinate] = limits[coordinate].min(to);
        }
    }
}

/// The first coordinate that moves a joint, and the share of the joint's rates at which that coordinate moves.
fn moved_by(robot: &Robot, joint: JointIndex) -> Option<(usize, f64)> {
    match robot.joints[joint.at()].source {
        Source::Coordinates { q, .. } => Some((q, 1.0)),
        Source::Follows { multiplier: 0.0, .. } => None,
        Source::Follows { leader, multiplier, .. } => match robot.joints[leader.at()].source {
            Source::Coordinates { q, .. } => Some((q, 1.0 / multiplier.abs())),
            Source::Follows { .. } => None,
        },
    }
}

/// Limits of velocity and acceleration of one of a joint's numbers. A follower of which nothing is known is as fast as its leader.
fn of_number(robot: &Robot, index: JointIndex, number: usize, options: &TimingOptions) -> (f64, f64) {
    let joint = &robot.joints[index.at()];
    let given = |list: &[NumberLimit]| {
        list.iter().rev().find(|own| (own.joint, own.number) == (index, number)).map(|own| own.limit)
    };
    let of_model = joint.velocity_limit.filter(|limit| *limit > 0.0);
    let usual = match (joint.motion, number) {
        _ if matches!(joint.source, Source::Follows { .. }) => f64::INFINITY,
        (JointType::Revolute { .. }, _) | (JointType::Planar, 2) => TURN_LIMIT,
        (JointType::FreeFlyer, 3..) => 0.5 * TURN_LIMIT,
        _ => SHIFT_LIMIT,
    };
    let velocity = given(&options.velocity).unwrap_or(of_model.unwrap_or(usual) * options.velocity_scale);
    (velocity, given(&options.acceleration).unwrap_or(velocity / options.ramp))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::models;

    #[test]
    fn overrides_defaults_and_scales() {
        let arm = models::seven_axis_arm();
        let robot = Robot::compose(&[(&arm, models::movable_object("arm"))]).unwrap();
        let root = robot.parts[0].root_joint.unwrap();
        let elbow = robot.joints.iter().position(|joint| joint.motion.configuration_size() == 1).unwrap();
        let limit = |joint, number, limit| NumberLimit { joint, number, limit };
        let elbow = JointIndex(elbow as u32);
        let options = TimingOptions {
            velocity_scale: 0.5,
            velocity: vec![limit(elbow, 0, 9.0), limit(elbow, 0, 0.25), limit(root, 1, 2.0)],
            acceleration: vec![limit(root, 1, 3.0)],
            ramp: 0.1,
            jerk_ramp: 0.2,
            ..TimingOptions::default()
        };
        let (limits, plain) = (RateLimits::of(&robot, &options), RateLimits::of(&robot, &TimingOptions::default()));
        let first = |joint| moved_by(&robot, joint).unwrap().0;
        let at = |limits: &RateLimits, i: usize| [limits.velocity[i], limits.acceleration[i], limits.jerk[i]];
        assert_eq!(at(&limits, first(elbow)), [0.25, 2.5, 12.5]);
        assert_eq!(at(&limits, first(root)), [0.5 * SHIFT_LIMIT, 5.0 * SHIFT_LIMIT, 25.0 * SHIFT_LIMIT]);
        assert_eq!(at(&limits, first(root) + 1), [2.0, 3.0, 15.0]);
        assert_eq!(limits.velocity[first(root) + 6], 0.25 * TURN_LIMIT);
        assert_eq!(at(&plain, first(root)), [SHIFT_LIMIT, 2.0 * SHIFT_LIMIT, f64::INFINITY]);
    }
}
