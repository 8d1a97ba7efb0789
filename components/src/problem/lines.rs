//! What is straight beside grasps: how grippers go to handles, and how objects leave their supports and come back to them.

use crate::constraint::{Frame, Placement, Polygon, Reference, RelativePose, Row};
use crate::problem::definition::{ApproachLine, GraphOptions, Lift, ObjectOptions, RestingPlane};
use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{GripperIndex, HandleIndex, JointIndex, SurfaceIndex};
use glam::DVec3;

/// Axes that enclose a smaller angle are parallel, radians: over a lift of a metre that is a micrometre.
const PARALLEL: f64 = 1e-6;

impl GraphOptions {
    /// How straight a gripper goes to a handle: as the handle asks, else as the gripper asks, else as all do; `None` for as it likes.
    #[must_use]
    pub fn line_to(&self, gripper: GripperIndex, handle: HandleIndex) -> Option<ApproachLine> {
        let of_handle = || self.handle_lines.iter().find(|(named, _)| *named == handle).map(|&(_, line)| line);
        let of_gripper = || self.gripper_lines.iter().find(|(named, _)| *named == gripper).map(|&(_, line)| line);
        of_handle().or_else(of_gripper).unwrap_or(self.approach_line)
    }

    /// What holds along a straight lift of an object off the supports of one body (`None`: what is fixed in the world): the pose against the body
    /// is that of the parameter in slot 0, but for the height. `None` where lifts are free, where the object does not lie there, and where
    /// there is no one normal: neither the supports of the body nor the faces of the object are parallel.
    #[must_use]
    pub fn lift_line(&self, robot: &Robot, object: usize, on: Option<JointIndex>) -> Option<RelativePose> {
        let object = self.objects.get(object).filter(|_| self.lift == Lift::Straight)?;
        let root = robot.parts.get(object.part.at())?.root_joint?;
        match (&object.plane, on) {
            (Some(plane), None) => Some(off_plane(plane, root)),
            (Some(_), Some(_)) => None,
            (None, _) => self.off_supports(robot, object, root, on),
        }
    }

    fn off_supports(
        &self,
        robot: &Robot,
        object: &ObjectOptions,
        root: JointIndex,
        on: Option<JointIndex>,
    ) -> Option<RelativePose> {
        let carries = |surface: &SurfaceIndex| {
            let link = &robot.links[robot.surfaces[surface.at()].link.at()];
            link.joint == on && link.part != object.part
        };
        let supports: Vec<_> = self.supports.iter().copied().filter(carries).collect();
        let lying = Placement::new(robot, &object.surfaces, &supports, 0.0).ok()?;
        let carrier = Frame { joint: on, joint_from_frame: crate::Pose::identity() };
        // The x axis of a polygon is its normal. The object does not turn, so its own normal keeps its direction too.
        let (a, b) = match (one_normal(&lying.supports), one_normal(&lying.object)) {
            (Some(support), _) => (support, Frame::of_joint(root)),
            (None, Some(face)) => (face, carrier),
            (None, None) => return None,
        };
        Some(along(a, b, 0))
    }
}

/// Off a plane, along its z axis.
fn off_plane(plane: &RestingPlane, root: JointIndex) -> RelativePose {
    along(Frame::world(plane.world_from_plane), Frame::of_joint(root), 2)
}

/// B keeps its pose in A, but for the translation along one axis of A.
fn along(a: Frame, b: Frame, axis: usize) -> RelativePose {
    let mut rows = [Some(Row::Parameter); 6];
    rows[axis] = None;
    RelativePose { a, b, rows, reference: Reference::Argument(0) }
}

/// The frame of the first polygon, where the normals of all are parallel.
fn one_normal(polygons: &[Polygon]) -> Option<Frame> {
    let normal = |polygon: &Polygon| polygon.frame.joint_from_frame.rotation * DVec3::X;
    let first = polygons.first()?;
    polygons.iter().all(|other| normal(first).cross(normal(other)).length() <= PARALLEL).then_some(first.frame)
}
