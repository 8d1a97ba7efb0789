//! When hands take and let go.

use crate::planner::trajectory::trajectory::Trajectory;
use foliate_components::path::{EventKind, events, fingers, knot_of_event};
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, LinkIndex};

/// A hand takes or lets go of an object. Where fingers are planned, the segment that begins with a grasp closes them, and the one before
/// a release has opened them. All joints stand still from `time` on for `dwell` seconds, in which a gripper closes or opens whose fingers
/// are not planned.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectoryEvent<'a> {
    /// Seconds, as the path counts them.
    pub time: f64,
    /// How long the robot stands still then, seconds.
    pub dwell: f64,
    /// Number of the segment that begins with it.
    pub segment: usize,
    /// What happens.
    pub kind: EventKind,
    /// The part that is taken or let go.
    pub object: &'a str,
    /// `part/gripper`.
    pub gripper: &'a str,
    /// `part/handle`.
    pub handle: &'a str,
    /// The joints of the gripper (those that mimic others left out), `part/joint`, and where they are when the hand has closed or
    /// opened: radians or metres.
    pub fingers: Vec<(&'a str, f64)>,
    /// The gripper in the robot.
    pub gripper_index: GripperIndex,
    /// The handle in the robot.
    pub handle_index: HandleIndex,
}

impl TrajectoryEvent<'_> {
    /// The link that the gripper is on.
    #[must_use]
    pub fn link(&self, trajectory: &Trajectory<'_>) -> LinkIndex {
        trajectory.robot.grippers[self.gripper_index.at()].link
    }
}

impl<'a> Trajectory<'a> {
    /// When hands take and let go, in the order of time; at one time releases come before grasps.
    #[must_use]
    pub fn events(&self) -> Vec<TrajectoryEvent<'a>> {
        let robot = self.robot;
        let told = events(self.path).into_iter().map(|event| {
            let time = event.time.unwrap_or_else(|| self.times(event.segment)[0]);
            let handle = &robot.handles[event.handle.at()];
            let joints: Vec<JointIndex> = fingers(robot, event.gripper);
            let names: Vec<&'a str> = joints.iter().map(|j| robot.joints[j.at()].name.as_str()).collect();
            let coordinates: Vec<usize> = joints.iter().filter_map(|joint| self.first_coordinate(*joint)).collect();
            let segment = &self.path.segments[event.segment];
            // Where the segment moves the fingers alone it is what closes or opens the hand.
            let moves_fingers = knot_of_event(segment, &coordinates) != segment.knots[0].as_slice();
            let ends = segment.timing.as_ref().and_then(|timing| timing.times.last()).filter(|_| moves_fingers);
            let done = ends.copied().unwrap_or(time + event.dwell);
            let positions = self.joints(&names).map(|joints| joints.at(done).positions);
            TrajectoryEvent {
                time,
                dwell: event.dwell,
                segment: event.segment,
                kind: event.kind,
                object: robot.parts[robot.links[handle.link.at()].part.at()].name.as_str(),
                gripper: robot.grippers[event.gripper.at()].name.as_str(),
                handle: handle.name.as_str(),
                fingers: names.into_iter().zip(positions.unwrap_or_default()).collect(),
                gripper_index: event.gripper,
                handle_index: event.handle,
            }
        });
        told.collect()
    }
}
