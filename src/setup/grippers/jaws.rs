//! Hands by their joints: short chains that begin at one body and move against each other.

use crate::setup::grippers::bodies::{beyond, is_beyond, leader};
use crate::setup::grippers::hand::{FingerRange, FoundGripper};
use crate::setup::grippers::measure::{Jaw, measured};
use foliate_components::robot::{JointIndex, JointType, Robot};
use std::collections::BTreeMap;

/// Most joints of one finger.
const JOINTS: usize = 4;
/// Longest finger, metres.
const LENGTH: f64 = 0.3;
/// Parts of names of joints that move a single jaw against a fixed one.
const WORDS: [&str; 4] = ["grip", "jaw", "finger", "claw"];

/// All hands with two jaws.
pub(super) fn jaws(robot: &Robot) -> Vec<FoundGripper> {
    let mut of_palm: BTreeMap<JointIndex, Vec<JointIndex>> = BTreeMap::new();
    for index in 0..robot.joints.len() as u32 {
        let joint = JointIndex(index);
        if let Some(palm) = robot.joints[joint.at()].parent.filter(|_| is_finger(robot, joint)) {
            of_palm.entry(palm).or_default().push(joint);
        }
    }
    let mut found: Vec<FoundGripper> = Vec::new();
    for (palm, roots) in &of_palm {
        let bodies: Vec<JointIndex> = roots.iter().flat_map(|&root| beyond(robot, root)).collect();
        // Joints inside a finger are no hand of their own.
        if found.iter().any(|hand| is_beyond(robot, Some(*palm), robot.links[hand.link.at()].joint)) {
            continue;
        }
        let Some(ranges) = ranges(robot, &bodies) else { continue };
        let jaw = match roots.as_slice() {
            [only] if is_named(robot, *only) => Jaw { palm: *palm, roots, is_single: true },
            [_] => continue,
            _ => Jaw { palm: *palm, roots, is_single: false },
        };
        found.extend(measured(robot, &jaw, &ranges));
    }
    found
}

/// Whether a joint begins a finger: it has bounds, and what it carries is short and has shapes.
fn is_finger(robot: &Robot, joint: JointIndex) -> bool {
    let record = &robot.joints[joint.at()];
    let moves = matches!(record.motion, JointType::Revolute { .. } | JointType::Prismatic { .. });
    let bodies = beyond(robot, joint);
    if !moves || bodies.len() > JOINTS || !bounds(robot, joint).is_some_and(|(low, high)| low < high) {
        return false;
    }
    let shapes = || robot.shapes.iter().filter(|s| robot.links[s.link.at()].joint.is_some_and(|b| bodies.contains(&b)));
    // The chain is short even stretched out.
    let chain: f64 = bodies[1..].iter().map(|b| robot.joints[b.at()].parent_from_joint.translation.length()).sum();
    let size = |shape: &foliate_components::robot::Shape| {
        shape.joint_from_shape.translation.length() + shape.geometry.radius_about_origin()
    };
    let longest = shapes().map(size).fold(0.0, f64::max);
    shapes().next().is_some() && chain + longest < LENGTH
}

/// The bounds of the coordinate that moves a joint.
fn bounds(robot: &Robot, joint: JointIndex) -> Option<(f64, f64)> {
    let record = &robot.joints[leader(robot, joint).at()];
    let (low, high) = (*record.lower.first()?, *record.upper.first()?);
    (low.is_finite() && high.is_finite()).then_some((low, high))
}

fn is_named(robot: &Robot, joint: JointIndex) -> bool {
    let name = robot.joints[joint.at()].name.to_lowercase();
    let name = name.rsplit('/').next().unwrap_or_default();
    WORDS.iter().any(|word| name.contains(word))
}

/// The coordinates that move these bodies, with their bounds, `open` at the lower one for now; none where one has no bounds.
fn ranges(robot: &Robot, bodies: &[JointIndex]) -> Option<Vec<FingerRange>> {
    let mut leaders: Vec<JointIndex> = bodies.iter().map(|&body| leader(robot, body)).collect();
    leaders.sort_unstable();
    leaders.dedup();
    let range =
        |joint: JointIndex| bounds(robot, joint).map(|(low, high)| FingerRange { joint, open: low, closed: high });
    leaders.into_iter().map(range).collect()
}
