//! What the limits of a joint mean: none, where they are numbers that no machine has.

use foliate_components::robot::model::JointKind;
use std::f64::consts::TAU;

/// From this on an angle of a limit means that there is none, radians: exporters write 1e9, 1e16 or 3.4e38.
const ENDLESS_ANGLE: f64 = 100.0;
/// The same of a length, metres.
const ENDLESS_LENGTH: f64 = 1000.0;
/// From this on a velocity means that there is none, rad/s or m/s.
const ENDLESS_VELOCITY: f64 = 1e5;
/// What remains beyond the other limit where one of two means none: two turns, or so many metres.
const REMAINS: (f64, f64) = (2.0 * TAU, 20.0);

/// A joint's range as it is meant, and a remark where that is not what is written: message and hint.
pub(super) struct Range {
    pub kind: JointKind,
    pub limits: (f64, f64),
    pub remark: Option<(String, &'static str)>,
}

/// The range of a revolute or prismatic joint with these finite limits.
pub(super) fn meant(kind: JointKind, (lower, upper): (f64, f64)) -> Range {
    let (endless, remains, unit) = match kind {
        JointKind::Revolute => (ENDLESS_ANGLE, REMAINS.0, "rad"),
        _ => (ENDLESS_LENGTH, REMAINS.1, "m"),
    };
    let written = format!("its limits are [{lower:e}, {upper:e}] {unit}");
    let hint = "give limits that the machine has, or `joint_bounds` in a scene";
    let (limits, meaning) = match (lower <= -endless, upper >= endless) {
        (true, true) => ((f64::NEG_INFINITY, f64::INFINITY), "it is read as a joint without limits".to_owned()),
        (true, false) => ((upper - remains, upper), format!("the lower one is read as {}", upper - remains)),
        (false, true) => ((lower, lower + remains), format!("the upper one is read as {}", lower + remains)),
        (false, false) if lower == upper => {
            let remark = (format!("its limits are equal: it stays at {lower}"), "give it a range, or make it fixed");
            return Range { kind, limits: (lower, upper), remark: Some(remark) };
        }
        (false, false) => return Range { kind, limits: (lower, upper), remark: None },
    };
    let is_free = limits == (f64::NEG_INFINITY, f64::INFINITY);
    let (kind, meaning) = match kind {
        JointKind::Revolute if is_free => (JointKind::Continuous, "it is read as continuous".to_owned()),
        JointKind::Prismatic if is_free => (kind, format!("{meaning}, of which searches draw values within 1 m of 0")),
        kind => (kind, meaning),
    };
    Range { kind, limits, remark: Some((format!("{written}, which no joint has: {meaning}"), hint)) }
}

/// A velocity limit; none where it is a number that no joint reaches.
pub(super) fn meant_velocity(velocity: Option<f64>) -> Option<f64> {
    velocity.filter(|velocity| *velocity < ENDLESS_VELOCITY)
}
