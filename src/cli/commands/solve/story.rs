//! A path in plain words: which state is entered, who picks up what, where it is put down, what is opened how far.

use crate::components::path::{Attachment, ManipulationPath, Segment};
use crate::components::robot::{GripperIndex, HandleIndex, JointIndex, JointType, Robot, Source};
use crate::systems::planning_model::Model;
use std::fmt::Write;

/// One line per change of who holds what and of the problem's own states, in the direction of travel.
pub(crate) fn tell(model: &Model, path: &ManipulationPath) -> String {
    let pairs = path.segments.windows(2);
    let lines = pairs.flat_map(|pair| entered(model, pair).into_iter().chain(changes(&model.problem.robot, pair)));
    lines.enumerate().fold(String::new(), |mut out, (number, line)| {
        let _ = writeln!(out, "  {:>2}. {line}", number + 1);
        out
    })
}

/// The problem's own state that begins here.
fn entered(model: &Model, pair: &[Segment]) -> Option<String> {
    let written = |segment: &Segment| model.graph.state(segment.state).written;
    let (before, now) = (written(&pair[0]), written(&pair[1])?);
    let state = model.problem.graph.states.get(now as usize)?;
    (before != Some(now)).then(|| format!("enters the state `{}`", state.name))
}

/// A grasp: what is held (see [`Attachment::Grasp`]), by whom, where.
type Hold = (JointIndex, GripperIndex, HandleIndex);

fn holds(segment: &Segment) -> Vec<Hold> {
    let hold = |attachment: &Attachment| match *attachment {
        Attachment::Grasp { object, gripper, handle, .. } => Some((object, gripper, handle)),
        Attachment::Contact { .. } | Attachment::Rest { .. } => None,
    };
    segment.attachments.iter().filter_map(hold).collect()
}

fn changes(robot: &Robot, pair: &[Segment]) -> Vec<String> {
    let (before, now) = (holds(&pair[0]), holds(&pair[1]));
    let knot = &pair[1].knots[0];
    let mut lines = Vec::new();
    for &(object, gripper, handle) in now.iter().filter(|hold| !before.contains(hold)) {
        let hand = &robot.grippers[gripper.at()].name;
        let verb = match floats(robot, object) && !before.iter().any(|other| other.0 == object) {
            true => "picks up",
            false => "takes hold of",
        };
        lines.push(format!("{hand} {verb} {}", held(robot, object, handle, knot)));
    }
    let mut put_down = Vec::new();
    for &(object, gripper, handle) in before.iter().filter(|hold| !now.contains(hold)) {
        if floats(robot, object) && !now.iter().any(|other| other.0 == object) {
            if !put_down.contains(&object) {
                put_down.push(object);
                lines.push(puts_down(robot, object, &before, &pair[1]));
            }
            continue;
        }
        let hand = &robot.grippers[gripper.at()].name;
        lines.push(format!("{hand} lets go of {}", held(robot, object, handle, knot)));
    }
    lines
}

fn puts_down(robot: &Robot, object: JointIndex, before: &[Hold], now: &Segment) -> String {
    let hands = before.iter().filter(|hold| hold.0 == object).map(|hold| robot.grippers[hold.1.at()].name.as_str());
    let hands = hands.collect::<Vec<_>>().join(" and ");
    let on = now.attachments.iter().find_map(|attachment| match *attachment {
        Attachment::Contact { object: lying, support, .. } if lying == object => {
            Some(robot.surfaces[support.0.at()].name.as_str())
        }
        Attachment::Rest { object: lying, on: Some(on) } if lying == object => Some(robot.links[on.at()].name.as_str()),
        _ => None,
    });
    let on = on.map_or_else(String::new, |on| format!(" on {on}"));
    format!("{hands} puts {} down{on} at {}", part_name(robot, object), position(robot, object, &now.knots[0]))
}

/// An object and where it is; of furniture the handle, and how far its joint is open.
fn held(robot: &Robot, object: JointIndex, handle: HandleIndex, knot: &[f64]) -> String {
    if floats(robot, object) {
        return format!("{} at {}", part_name(robot, object), position(robot, object, knot));
    }
    let (handle, joint) = (&robot.handles[handle.at()].name, &robot.joints[object.at()]);
    match joint.source {
        Source::Coordinates { q, .. } => format!("{handle} ({} at {:.3})", joint.name, knot[q]),
        Source::Follows { .. } => handle.clone(),
    }
}

fn floats(robot: &Robot, object: JointIndex) -> bool {
    matches!(robot.joints[object.at()].motion, JointType::FreeFlyer)
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
