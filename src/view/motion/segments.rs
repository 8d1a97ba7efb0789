//! What happens on each leaf, in words, and when hands take and let go.

use crate::inspection::words::ShortNames;
use crate::planner::trajectory::segments::{Held, TrajectorySegment};
use crate::planner::trajectory::trajectory::Trajectory;
use crate::view::document::path::{EventEntry, SegmentEntry};
use foliate_components::path::{EventKind, fingers};
use foliate_components::robot::{JointType, Robot, Source};
use std::collections::HashMap;

/// Where the states and the transitions of segments are in the list of a graph, by name.
#[derive(Clone, Debug, Default)]
pub(crate) struct GraphPlaces {
    pub states: HashMap<String, usize>,
    pub transitions: HashMap<String, usize>,
    /// By transition what it passes, in order.
    pub waypoints: Vec<Vec<String>>,
}

impl GraphPlaces {
    /// What a segment ends at, where its transition has other segments behind it: `number` of `count` segments in a row.
    fn waypoint(&self, transition: Option<usize>, number: usize, count: usize) -> Option<String> {
        let waypoints = self.waypoints.get(transition?)?;
        (count == waypoints.len() + 1).then(|| waypoints.get(number).cloned()).flatten()
    }
}

/// A coordinate that changes by less stands still, metres and radians.
const STILL: f64 = 1e-6;

/// The segments of a motion. `transitions` has a name for each.
pub(crate) fn segments(
    trajectory: &Trajectory<'_>,
    transitions: &[String],
    places: &GraphPlaces,
    names: &ShortNames,
) -> Vec<SegmentEntry> {
    let all = trajectory.segments();
    let mut colours: HashMap<&str, usize> = HashMap::new();
    let start = trajectory.start();
    let changes = changes(&all);
    let runs = runs(transitions, all.len());
    let entry = |segment: &TrajectorySegment<'_>| {
        let (number, count) = runs[segment.index];
        let transition = transitions.get(segment.index).and_then(|name| places.transitions.get(name)).copied();
        let next = colours.len();
        let colour = *colours.entry(trajectory.segment_state(segment.index)).or_insert(next);
        SegmentEntry {
            from: segment.start - start,
            to: segment.end - start,
            state: places.states.get(segment.state).copied(),
            transition,
            waypoint: places.waypoint(transition, number, count),
            words: words(trajectory, (&all, &changes), segment.index, names),
            colour,
            held: segment.held.iter().map(|held| [held.gripper.to_owned(), held.handle.to_owned()]).collect(),
        }
    };
    all.iter().map(entry).collect()
}

/// By segment its place among those of its transition that follow each other, and how many these are.
fn runs(transitions: &[String], count: usize) -> Vec<(usize, usize)> {
    let mut runs = Vec::with_capacity(count);
    while runs.len() < count {
        let first = runs.len();
        let name = transitions.get(first);
        let same = (first..count).take_while(|&other| name.is_some() && transitions.get(other) == name).count().max(1);
        runs.extend((0..same).map(|number| (number, same)));
    }
    runs
}

/// By segment the next one in which hands hold something else.
fn changes(all: &[TrajectorySegment<'_>]) -> Vec<Option<usize>> {
    let mut changes = vec![None; all.len()];
    for index in (1..all.len()).rev() {
        changes[index - 1] = if all[index].held == all[index - 1].held { changes[index] } else { Some(index) };
    }
    changes
}

/// What happens along a segment.
fn words(
    trajectory: &Trajectory<'_>,
    (all, changes): (&[TrajectorySegment<'_>], &[Option<usize>]),
    index: usize,
    names: &ShortNames,
) -> String {
    let robot = trajectory.robot();
    let segment = &all[index];
    if let Some(words) = fingers_move(trajectory, all, index, names) {
        return words;
    }
    let mut objects: Vec<&str> = Vec::new();
    for held in &segment.held {
        if !objects.contains(&held.object) {
            objects.push(held.object);
        }
    }
    let next = changes[index].map(|other| &all[other]);
    let clause = |object: &&str| {
        let holders: Vec<&Held<'_>> = segment.held.iter().filter(|held| held.object == *object).collect();
        let hands: Vec<&str> = holders.iter().map(|held| names.of_name(held.gripper)).collect();
        let (carries, moves) = if hands.len() > 1 { ("carry", "move") } else { ("carries", "moves") };
        match floats(robot, object) {
            true => format!("{} {carries} {object}{}", joined(&hands), put_down(next, object)),
            false => format!("{} {moves} {}", joined(&hands), names.of_name(holders[0].handle)),
        }
    };
    let mut clauses: Vec<String> = objects.iter().map(clause).collect();
    clauses.extend(next.and_then(|next| reaches(segment, next, names)));
    if clauses.is_empty() { "moves with empty hands".into() } else { clauses.join("; ") }
}

fn joined(names: &[&str]) -> String {
    match names {
        [all @ .., last] if !all.is_empty() => format!("{} and {last}", all.join(", ")),
        _ => names.concat(),
    }
}

fn floats(robot: &Robot, part: &str) -> bool {
    let root = robot.part(part).and_then(|part| robot.parts[part.at()].root_joint);
    root.is_some_and(|root| robot.joints[root.at()].motion == JointType::FreeFlyer)
}

/// Where an object is put down, if no hand holds it any more after the next grasp or release.
fn put_down(next: Option<&TrajectorySegment<'_>>, object: &str) -> String {
    let Some(next) = next.filter(|next| next.held.iter().all(|hold| hold.object != object)) else {
        return String::new();
    };
    let on = next.carried.iter().find(|carry| carry.object == object).and_then(|carry| carry.link);
    let on = on.map_or_else(String::new, |link| format!(" on {}", link.split('/').next().unwrap_or(link)));
    format!(" to put it down{on}")
}

/// Who takes or lets go of what is held by another, when that is next.
fn reaches(segment: &TrajectorySegment<'_>, next: &TrajectorySegment<'_>, names: &ShortNames) -> Option<String> {
    if let Some(taken) = next.held.iter().find(|hold| !segment.held.contains(hold)) {
        return Some(format!("{} reaches for {}", names.of_name(taken.gripper), names.of_name(taken.handle)));
    }
    let let_go = segment.held.iter().find(|hold| !next.held.contains(hold))?;
    let is_held = next.held.iter().any(|hold| hold.object == let_go.object);
    is_held.then(|| format!("{} is about to let go", names.of_name(let_go.gripper)))
}

/// That a hand opens or closes, where nothing else moves.
fn fingers_move(
    trajectory: &Trajectory<'_>,
    all: &[TrajectorySegment<'_>],
    index: usize,
    names: &ShortNames,
) -> Option<String> {
    let robot = trajectory.robot();
    let knots = &trajectory.path().segments[index].knots;
    let (first, last) = (&knots[0], &knots[knots.len() - 1]);
    let moved: Vec<usize> = (0..first.len()).filter(|&i| (first[i] - last[i]).abs() > STILL).collect();
    if moved.is_empty() {
        return None;
    }
    let coordinates = |gripper| -> Vec<usize> {
        let joints = fingers(robot, gripper).into_iter();
        joints
            .filter_map(|joint| match robot.joints[joint.at()].source {
                Source::Coordinates { q, .. } => Some(q),
                Source::Follows { .. } => None,
            })
            .collect()
    };
    let hand = (0..robot.grippers.len() as u32).map(foliate_components::robot::GripperIndex).find(|&gripper| {
        let own = coordinates(gripper);
        moved.iter().all(|i| own.contains(i))
    })?;
    let name = &robot.grippers[hand.at()].name;
    let held_at = |index: usize| all.get(index)?.held.iter().find(|held| held.gripper == name);
    // The hand still holds while it opens: it lets go at the end of the motion.
    let lets_go = index + 1 < all.len() && held_at(index + 1).is_none();
    Some(match held_at(index) {
        Some(held) if lets_go => format!("{} opens to let go of {}", names.of_name(name), held.object),
        Some(held) => format!("{} closes on {}", names.of_name(name), held.object),
        None => format!("{} opens or closes", names.of_name(name)),
    })
}

/// When hands take and let go.
pub(crate) fn events(trajectory: &Trajectory<'_>, names: &ShortNames) -> Vec<EventEntry> {
    let start = trajectory.start();
    let entry = |event: crate::planner::trajectory::events::TrajectoryEvent<'_>| {
        let (kind, verb) = match event.kind {
            EventKind::Grasp => ("grasp", "takes"),
            EventKind::Release => ("release", "lets go of"),
        };
        EventEntry {
            time: event.time - start,
            dwell: event.dwell,
            kind,
            words: format!("{} {verb} {}", names.of_name(event.gripper), names.of_name(event.handle)),
            gripper: event.gripper.to_owned(),
            handle: event.handle.to_owned(),
        }
    };
    trajectory.events().into_iter().map(entry).collect()
}
