//! A path in plain words: who picks up what, where it is put down.

use foliate::components::path::{Attachment, ManipulationPath};
use foliate::components::robot::{JointIndex, Robot, Source};
use std::fmt::Write;

/// One line per change of who carries what, in the direction of travel.
pub(crate) fn tell(robot: &Robot, path: &ManipulationPath) -> String {
    let mut out = String::new();
    let mut number = 0;
    for pair in path.segments.windows(2) {
        let knot = &pair[1].knots[0];
        for now in pair[1].attachments.iter().filter(|a| !pair[0].attachments.contains(a)) {
            let object = object_of(now);
            let before = pair[0].attachments.iter().filter(|a| object_of(a) == object).collect::<Vec<_>>();
            if let Some(line) = change(robot, object, &before, now, knot) {
                number += 1;
                let _ = writeln!(out, "  {number:>2}. {line}");
            }
        }
    }
    out
}

fn change(robot: &Robot, object: JointIndex, before: &[&Attachment], now: &Attachment, knot: &[f64]) -> Option<String> {
    let name = part_name(robot, object);
    let place = position(robot, object, knot);
    match now {
        Attachment::Grasp { gripper, .. } => {
            let hand = &robot.grippers[gripper.at()].name;
            let held = before.iter().any(|a| matches!(a, Attachment::Grasp { .. }));
            let verb = if held { "takes hold of" } else { "picks up" };
            Some(format!("{hand} {verb} {name} at {place}"))
        }
        Attachment::Contact { support, .. } => {
            let hands = before.iter().filter_map(|a| match a {
                Attachment::Grasp { gripper, .. } => Some(robot.grippers[gripper.at()].name.as_str()),
                Attachment::Contact { .. } | Attachment::Rest { .. } => None,
            });
            let hands: Vec<_> = hands.collect();
            let surface = &robot.surfaces[support.0.at()].name;
            (!hands.is_empty()).then(|| format!("{} puts {name} down on {surface} at {place}", hands.join(" and ")))
        }
        Attachment::Rest { .. } => Some(format!("{name} is let go at {place}")),
    }
}

fn object_of(attachment: &Attachment) -> JointIndex {
    match *attachment {
        Attachment::Grasp { object, .. } | Attachment::Contact { object, .. } | Attachment::Rest { object, .. } => {
            object
        }
    }
}

fn part_name(robot: &Robot, object: JointIndex) -> &str {
    &robot.parts[robot.joints[object.at()].part.at()].name
}

/// (x, y, z) of an object's root in metres, from its coordinates.
fn position(robot: &Robot, object: JointIndex, q: &[f64]) -> String {
    match robot.joints[object.at()].source {
        Source::Coordinates { q: i, .. } => format!("({:.3}, {:.3}, {:.3})", q[i], q[i + 1], q[i + 2]),
        Source::Follows { .. } => "?".into(),
    }
}
