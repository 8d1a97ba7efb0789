//! Neighbours that need not be tested: links that one joint joins, and that touch wherever it is.
//!
//! Models without an SRDF say nothing about which links overlap by design. Two links that meet at a joint usually do, at
//! every value of it, and to test them would forbid every motion. Nothing else is left alone: what is fixed to a neighbour is
//! no neighbour, and a pair that touches at some values only is a pair that may collide.

use crate::collision::scene::pair_query::touch;
use crate::collision::scene::scene_solid::{SceneSolid, Solids};
use foliate_components::Pose;
use foliate_components::robot::{DisabledPair, JoinedLinks, Joint, JointType, LinkIndex, PartIndex, Robot};
use glam::DQuat;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Values of a joint that are tested, both ends of its range included.
const VALUES: u32 = 17;

/// The link pairs of a part that one joint joins ([`Robot::joined_links`]) and of which some shapes touch at each of 17 values,
/// evenly over the joint's range; over a full turn where it has no limits. Links that a joint of several coordinates, or one
/// that slides without limits, joins are not among them.
#[must_use]
pub fn adjacent_links(robot: &Robot, part: PartIndex) -> Vec<DisabledPair> {
    adjacent_links_while(robot, part, &|| true).unwrap_or_default()
}

/// As [`adjacent_links`]; none once `go_on` says no, which is asked while trees of meshes are built and between pairs.
#[must_use]
pub fn adjacent_links_while(robot: &Robot, part: PartIndex, go_on: &dyn Fn() -> bool) -> Option<Vec<DisabledPair>> {
    let joined = robot.joined_links(&robot.parts[part.at()]);
    let mut solids = Solids::new(go_on);
    let mut of_link: HashMap<LinkIndex, Vec<SceneSolid>> = HashMap::new();
    for pair in &joined {
        of_link.entry(pair.first).or_default();
        of_link.entry(pair.second).or_default();
    }
    for shape in &robot.shapes {
        if let Some(of_link) = of_link.get_mut(&shape.link) {
            of_link.push(SceneSolid::new(robot, shape, solids.of(&shape.geometry)?));
        }
    }
    let touches = |pair: &JoinedLinks| {
        if !go_on() {
            return false;
        }
        let (Some(first), Some(second)) = (of_link.get(&pair.first), of_link.get(&pair.second)) else { return false };
        touch_always(&robot.joints[pair.joint.at()], first, second)
    };
    let found = joined.into_iter().filter(touches).map(|pair| pair.disabled(DisabledPair::ADJACENT)).collect();
    go_on().then_some(found)
}

/// Whether some solid of the body that a joint moves touches one of the body that carries it, at all values.
fn touch_always(joint: &Joint, carrier: &[SceneSolid], moved: &[SceneSolid]) -> bool {
    let Some(values) = values(joint) else { return false };
    values.into_iter().all(|value| {
        let by = match joint.motion {
            JointType::Revolute { axis } => Pose::from_rotation(DQuat::from_axis_angle(axis, value)),
            JointType::Prismatic { axis } => Pose::from_translation(axis * value),
            JointType::Planar | JointType::FreeFlyer => return false,
        };
        let X_PJ = joint.parent_from_joint * by;
        carrier.iter().any(|a| moved.iter().any(|b| touch(a, &Pose::IDENTITY, b, &X_PJ)))
    })
}

/// Where a joint of one coordinate is tested.
fn values(joint: &Joint) -> Option<Vec<f64>> {
    let (low, high) = match joint.motion {
        JointType::Revolute { .. } => {
            let (low, high) = (joint.lower[0], joint.upper[0]);
            // One limit alone leaves a full turn and more.
            if low.is_finite() && high.is_finite() { (low, high.min(low + TAU)) } else { (0.0, TAU) }
        }
        JointType::Prismatic { .. } => (joint.lower[0], joint.upper[0]),
        JointType::Planar | JointType::FreeFlyer => return None,
    };
    let share = |i| f64::from(i) / f64::from(VALUES - 1);
    (low.is_finite() && high.is_finite()).then(|| (0..VALUES).map(|i| low + (high - low) * share(i)).collect())
}
