//! Events: every grasp and every release that the attachments make is listed, nothing else is, and there everything stands still.

use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::kind::Kind;
use crate::check::world::documents::Frames;
use crate::check::world::models::{Value, World};
use crate::path_file::document::{EventEntry, FORMAT_1, PathFile, SegmentEntry};
use std::collections::BTreeMap;

/// Rounding of times, and of fingers' positions: seconds, radians, metres.
const SLACK: f64 = 1e-9;

/// By as much an object that is taken may be written anew: metres, radians.
const STILL: f64 = 1e-6;

/// What happens: `grasp` or `release`, object, gripper, handle.
type Happening<'f> = (&'f str, &'f str, &'f str, &'f str);

/// Compares the events of a file with its attachments, its knots and its models.
pub(crate) fn check(file: &PathFile, world: &World, frames: &Frames, report: &mut CheckReport) {
    if file.format == FORMAT_1 {
        return;
    }
    let listed = file.events.as_deref().unwrap_or_default();
    if !listed.is_sorted_by_key(|event| event.segment) {
        report.violate(Place::FILE, Kind::Event, "events are not in the order of travel", None, None);
    }
    for (index, pair) in file.segments.windows(2).enumerate() {
        let index = index + 1;
        let mut open = happenings(&pair[0], &pair[1]);
        let is_event = !open.is_empty();
        for event in listed.iter().filter(|event| event.segment == index) {
            let told = (event.kind.as_str(), event.object.as_str(), event.gripper.as_str(), event.handle.as_str());
            match open.iter().position(|happening| *happening == told) {
                Some(found) => drop(open.swap_remove(found)),
                None => missed(index, told, "is listed and does not happen", report),
            }
            times(index, event, &pair[1], report);
            fingers(event, &pair[1], (world, frames), report);
        }
        open.into_iter().for_each(|happening| missed(index, happening, "is not listed", report));
        if is_event {
            stands(index, pair, file, report);
        }
    }
}

fn missed(index: usize, (kind, object, gripper, handle): Happening<'_>, what: &str, report: &mut CheckReport) {
    let [object, gripper, handle] = [object, gripper, handle].map(shown);
    let subject = format!("{kind} of {object} by {gripper} > {handle} {what}");
    report.violate(Place::at(index, 0.0), Kind::Event, subject, None, None);
}

/// Grasps that end and begin from a segment to the next.
fn happenings<'f>(before: &'f SegmentEntry, after: &'f SegmentEntry) -> Vec<Happening<'f>> {
    let grasps = |segment: &'f SegmentEntry| {
        let of = |entry: &'f crate::path_file::document::AttachmentEntry| {
            Some((entry.object.as_str(), entry.gripper.as_deref()?, entry.handle.as_deref()?))
        };
        segment.attachments.iter().filter_map(of).collect::<Vec<_>>()
    };
    let (had, has) = (grasps(before), grasps(after));
    let ends = had.iter().filter(|grasp| !has.contains(grasp)).map(|&(o, g, h)| ("release", o, g, h));
    let begins = has.iter().filter(|grasp| !had.contains(grasp)).map(|&(o, g, h)| ("grasp", o, g, h));
    ends.chain(begins).collect()
}

/// An event happens when its segment begins, and the segment stands still as long as the event says.
fn times(index: usize, event: &EventEntry, segment: &SegmentEntry, report: &mut CheckReport) {
    let place = Place::at(index, 0.0);
    if let (Some(time), Some(&begins)) = (event.time, segment.times.iter().flatten().next()) {
        // Compared so that NaN is off.
        let is_then = (time - begins).abs() <= SLACK;
        if !is_then {
            report.violate(place, Kind::Event, "time of an event, and of its segment", time, begins);
        }
    }
    let stands = standstill(segment);
    if event.dwell > stands + SLACK {
        report.violate(place, Kind::EventMoves, "a segment stands still for less than the dwell", stands, event.dwell);
    }
}

/// How long a segment stands still at its beginning, seconds.
fn standstill(segment: &SegmentEntry) -> f64 {
    let (Some(times), Some(velocities)) = (&segment.times, &segment.velocities) else { return 0.0 };
    let first = &segment.knots[0];
    let is_still = |(knot, row): &(&Vec<f64>, &Vec<f64>)| *knot == first && row.iter().all(|v| *v == 0.0);
    let still = segment.knots.iter().zip(velocities).take_while(is_still).count();
    times[still.max(1) - 1] - times[0]
}

/// At an event all velocities are zero.
fn stands(index: usize, pair: &[SegmentEntry], file: &PathFile, report: &mut CheckReport) {
    let ends = [pair[0].velocities.iter().flatten().next_back(), pair[1].velocities.iter().flatten().next()];
    for row in ends.into_iter().flatten() {
        for (column, &velocity) in row.iter().enumerate().filter(|(_, v)| **v != 0.0) {
            let subject = format!("{} moves at an event", shown(&file.coordinates[column]));
            report.violate(Place::at(index, 0.0), Kind::EventMoves, subject, velocity, 0.0);
        }
    }
}

/// The fingers of an event are those of its gripper, and are where the segment's first knot has them; where the segment moves them alone,
/// where the last one has them.
fn fingers(event: &EventEntry, segment: &SegmentEntry, (world, frames): (&World, &Frames), report: &mut CheckReport) {
    let place = Place::at(event.segment, 0.0);
    let expected = fingers_of(&event.gripper, world, frames);
    let (first, last) = (&segment.knots[0], &segment.knots[segment.knots.len() - 1]);
    let moved: Vec<usize> = (0..first.len()).filter(|&column| (first[column] - last[column]).abs() > STILL).collect();
    let is_theirs = |column: &usize| expected.values().any(|own| own == column);
    let knot = if !moved.is_empty() && moved.iter().all(is_theirs) { last } else { first };
    for (name, &column) in &expected {
        let stands = knot[column];
        match event.fingers.get(*name) {
            None => report.violate(place, Kind::Event, format!("finger {name} is not listed"), None, None),
            // Compared so that NaN is off.
            Some(&said) if (said - stands).abs() <= SLACK => {}
            Some(&said) => report.violate(place, Kind::Event, format!("finger {name}"), said, stands),
        }
    }
    for name in event.fingers.keys().filter(|name| !expected.contains_key(name.as_str())) {
        let subject = format!("{} is no finger of {}", shown(name), shown(&event.gripper));
        report.violate(place, Kind::Event, subject, None, None);
    }
}

/// Joints of one coordinate beyond the link of a gripper that lead to no other gripper: the column of each.
fn fingers_of<'w>(gripper: &str, world: &'w World, frames: &Frames) -> BTreeMap<&'w str, usize> {
    let Some((link, _)) = frames.grippers.get(gripper) else { return BTreeMap::new() };
    let above = |body: usize| std::iter::successors(Some(body), |&b| world.bodies[b].parent);
    let hand = link.frame.body;
    let is_beyond = |body: usize| hand.is_none_or(|hand| above(body).skip(1).any(|b| b == hand));
    let others: Vec<usize> =
        frames.grippers.iter().filter(|(name, _)| *name != gripper).filter_map(|(_, (l, _))| l.frame.body).collect();
    let leads_on = |body: usize| others.iter().any(|&other| above(other).any(|b| b == body));
    let finger = |body: usize| match &world.bodies[body].value {
        Value::Columns(columns) if world.bodies[body].motion.configuration_size() == 1 => {
            Some((world.bodies[body].name.as_str(), columns[0]))
        }
        _ => None,
    };
    let bodies = world.parts[link.part].bodies.clone();
    bodies.filter(|&body| is_beyond(body) && !leads_on(body)).filter_map(finger).collect()
}
