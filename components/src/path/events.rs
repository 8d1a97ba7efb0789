//! Events of a path: where a hand takes or lets go of an object.

use crate::path::manipulation_path::{Attachment, ManipulationPath, Segment};

use crate::robot::indices::{GripperIndex, HandleIndex, JointIndex};

/// What happens at an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EventKind {
    /// The gripper lets go of the handle.
    Release,
    /// The gripper takes the handle.
    Grasp,
}

/// A hand takes or lets go of an object. It happens at the joint knot of two segments. Where fingers are planned, the segment that
/// begins with a grasp closes them, and the one before a release opens them. In a path with times the next segment begins by standing
/// still, while the gripper moves whose fingers are not planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Number of the segment that begins with it.
    pub segment: usize,
    /// Seconds from the start of the path; `None` in a path without times.
    pub time: Option<f64>,
    /// How long the segment stands still at its beginning, seconds.
    pub dwell: f64,
    /// What happens.
    pub kind: EventKind,
    /// Root joint of the object; of a part that is fixed in the world the joint that moves the held link.
    pub object: JointIndex,
    /// Which gripper.
    pub gripper: GripperIndex,
    /// Which handle.
    pub handle: HandleIndex,
}

/// The events of a path in the order of travel; at one knot releases come before grasps.
#[must_use]
pub fn events(path: &ManipulationPath) -> Vec<Event> {
    let mut events = Vec::new();
    for (index, pair) in path.segments.windows(2).enumerate() {
        let (before, after) = (&pair[0], &pair[1]);
        let (segment, time) = (index + 1, after.timing.as_ref().and_then(|timing| timing.times.first().copied()));
        let event = |kind, (object, gripper, handle)| Event {
            segment,
            time,
            dwell: standstill(after),
            kind,
            object,
            gripper,
            handle,
        };
        let (had, has): (Vec<_>, Vec<_>) = (grasps(before).collect(), grasps(after).collect());
        events.extend(had.iter().filter(|g| !has.contains(g)).map(|&grasp| event(EventKind::Release, grasp)));
        events.extend(has.iter().filter(|g| !had.contains(g)).map(|&grasp| event(EventKind::Grasp, grasp)));
    }
    events
}

fn grasps(segment: &Segment) -> impl Iterator<Item = (JointIndex, GripperIndex, HandleIndex)> + '_ {
    segment.attachments.iter().filter_map(|attachment| match *attachment {
        Attachment::Grasp { object, gripper, handle, .. } => Some((object, gripper, handle)),
        Attachment::Contact { .. } | Attachment::Rest { .. } => None,
    })
}

/// Objects that are taken may be written anew by as much: metres, radians.
const STILL: f64 = 1e-6;

/// The knot of a segment at which a gripper has done what the event says that begins it: the last one where the segment moves its
/// `fingers` alone, else the first one. Fingers are numbers of a configuration.
#[must_use]
pub fn knot_of_event<'s>(segment: &'s Segment, fingers: &[usize]) -> &'s [f64] {
    let (first, last) = (&segment.knots[0], &segment.knots[segment.knots.len() - 1]);
    let moved: Vec<usize> = (0..first.len()).filter(|&i| (first[i] - last[i]).abs() > STILL).collect();
    let is_of_fingers = !moved.is_empty() && moved.iter().all(|i| fingers.contains(i));
    if is_of_fingers { last } else { first }
}

/// How long a segment stands still at its beginning, seconds.
fn standstill(segment: &Segment) -> f64 {
    let Some(timing) = &segment.timing else { return 0.0 };
    let is_still = |row: &Vec<f64>| row.iter().all(|v| *v == 0.0);
    let first = &segment.knots[0];
    let still = segment.knots.iter().zip(&timing.velocities).take_while(|(q, v)| *q == first && is_still(v)).count();
    timing.times[still.max(1) - 1] - timing.times[0]
}
