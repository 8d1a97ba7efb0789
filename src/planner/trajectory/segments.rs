//! The segments of a trajectory, and what is held along each.

use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::path::Attachment;

/// A motion on one leaf.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectorySegment<'a> {
    /// Its number, from 0.
    pub index: usize,
    /// When it begins, seconds.
    pub start: f64,
    /// When it ends, seconds; the next one begins then.
    pub end: f64,
    /// The state of the constraint graph in which it lies.
    pub state: &'a str,
    /// What grippers hold along all of it.
    pub held: Vec<Held<'a>>,
    /// What objects follow along all of it. An object that is held and not listed moves on its own, as its handle lets it.
    pub carried: Vec<Carry<'a>>,
}

/// An object follows a link rigidly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Carry<'a> {
    /// The part.
    pub object: &'a str,
    /// `part/link`: of a gripper, or of what the object lies on. None where it just stays where it is.
    pub link: Option<&'a str>,
}

/// A gripper holds an object by a handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held<'a> {
    /// `part/gripper`.
    pub gripper: &'a str,
    /// The part that is held.
    pub object: &'a str,
    /// `part/handle`.
    pub handle: &'a str,
}

impl<'a> Trajectory<'a> {
    /// The segments in the order of time.
    #[must_use]
    pub fn segments(&self) -> Vec<TrajectorySegment<'a>> {
        (0..self.path.segments.len()).map(|index| self.segment(index)).collect()
    }

    /// The segment of a time; where two meet, the later one.
    #[must_use]
    pub fn segment_at(&self, time: f64) -> TrajectorySegment<'a> {
        self.segment(self.moment(time).segment)
    }

    /// The name of a segment's state.
    #[cfg(feature = "view")]
    pub(crate) fn segment_state(&self, index: usize) -> &'a str {
        self.states[index]
    }

    fn segment(&self, index: usize) -> TrajectorySegment<'a> {
        let times = self.times(index);
        let grasps = self.path.segments[index].attachments.iter().filter_map(|attachment| match *attachment {
            Attachment::Grasp { gripper, handle, .. } => Some((gripper, handle)),
            Attachment::Contact { .. } | Attachment::Rest { .. } => None,
        });
        let robot = self.robot;
        let held = grasps.map(|(gripper, handle)| Held {
            gripper: robot.grippers[gripper.at()].name.as_str(),
            object: robot.parts[robot.links[robot.handles[handle.at()].link.at()].part.at()].name.as_str(),
            handle: robot.handles[handle.at()].name.as_str(),
        });
        let carried = self.carried[index].iter().map(|carried| Carry {
            object: robot.parts[robot.joints[carried.object.at()].part.at()].name.as_str(),
            link: carried.link.map(|link| robot.links[link.at()].name.as_str()),
        });
        let (start, end, state) = (times[0], times[times.len() - 1], self.states[index]);
        TrajectorySegment { index, start, end, state, held: held.collect(), carried: carried.collect() }
    }
}
