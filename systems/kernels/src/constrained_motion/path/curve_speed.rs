//! How fast a point of a body moves along a curve over time.
//!
//! Within a step that takes h seconds the velocity of a point p is the mean one, to within ½ h sup‖p″‖, which the largest speeds and
//! accelerations of the step's cubics bound (`bounds`). A step is as long as the accuracy lets it be.

use crate::constrained_motion::bounds::joint_links::{Pace, links_of};
use crate::constrained_motion::bounds::point_rates::{BoundMemory, PointRates};
use crate::constrained_motion::path::curve_residual::set_pace;
use crate::curve::cubic::Cubic;
use crate::curve::hermite::{HermiteCurve, normalise_quaternions};
use crate::kinematics::{AttachmentTree, Kinematics, RigidAttachment, WeightedPoint};
use foliate_components::Pose;
use foliate_components::constraint::Frame;
use foliate_components::robot::Robot;
use glam::DVec3;

/// Steps are not shorter than this, as a share of a piece.
const SHORTEST: f64 = 1e-6;
/// The share of a speed by which its bound may be too large.
const ACCURACY: f64 = 1e-3;

/// Bounds the speed of the origin of a frame in the world along a curve: at least its largest, m/s, and at most a thousandth more, or
/// `enough` where it is nowhere faster. `rigid_attachments` carry objects along, in dependency order. A piece that takes no time counts as still.
///
/// # Panics
/// If the curve is not one of the robot's configurations, or a joint is not the robot's.
#[must_use]
pub fn curve_speed(
    robot: &Robot,
    kinematics: &Kinematics,
    rigid_attachments: &[RigidAttachment],
    frame: &Frame,
    curve: &HermiteCurve<'_>,
    enough: f64,
) -> f64 {
    let carried = rigid_attachments.iter().map(|attachment| (attachment.object, attachment.carrier));
    let tree = AttachmentTree::with_carried(robot, carried);
    let is_free = vec![true; robot.space.dimension()];
    let point = WeightedPoint { body: frame.joint, weight: 1.0, point: frame.joint_from_frame.translation };
    let mut walk = Walk {
        robot,
        kinematics,
        rigid_attachments,
        point,
        rates: PointRates::new(&tree, None, [point], |joint| links_of(robot, joint, &is_free)),
        cubics: Vec::new(),
        q: vec![0.0; robot.space.size()],
        start: vec![Pose::identity(); kinematics.bodies()],
        end: vec![Pose::identity(); kinematics.bodies()],
        pace: (Vec::new(), Vec::new()),
        memory: BoundMemory::default(),
        most: enough,
    };
    let size = robot.space.size();
    for piece in 0..curve.pieces() {
        let duration = curve.times[piece + 1] - curve.times[piece];
        if duration > 0.0 {
            walk.cubics.clear();
            walk.cubics.extend((0..size).map(|coordinate| curve.cubic(size, piece, coordinate)));
            walk.piece(duration);
        }
    }
    walk.most
}

/// A curve on the way.
struct Walk<'a> {
    robot: &'a Robot,
    kinematics: &'a Kinematics,
    rigid_attachments: &'a [RigidAttachment],
    point: WeightedPoint,
    rates: PointRates,
    /// Of the current piece.
    cubics: Vec<Cubic>,
    q: Vec<f64>,
    /// Where bodies are at the start and at the end of a step.
    start: Vec<Pose>,
    end: Vec<Pose>,
    pace: (Vec<f64>, Vec<f64>),
    memory: BoundMemory,
    /// The largest bound so far.
    most: f64,
}

impl Walk<'_> {
    fn piece(&mut self, duration: f64) {
        let (mut from, mut width) = (0.0, 1.0_f64);
        self.place(from);
        std::mem::swap(&mut self.start, &mut self.end);
        while from < 1.0 {
            let to = (from + width).min(1.0);
            let seconds = (to - from) * duration;
            let (delta, bend) = (&mut self.pace.0, &mut self.pace.1);
            set_pace(&self.robot.space, &self.cubics, (from, to), delta, bend);
            let rates = self.rates.rates(&Pace { delta, bend }, &self.start, &mut self.memory);
            let spread = 0.5 * rates.acceleration / seconds;
            // No farther than the point can come, and not by much less than it does.
            let surely = rates.speed / seconds;
            let is_slow = surely <= self.most;
            if !is_slow && spread > ACCURACY * self.most && to - from > SHORTEST {
                width = 0.5 * (to - from);
                continue;
            }
            self.place(to);
            let mean = (at(&self.point, &self.end) - at(&self.point, &self.start)).length() / seconds;
            self.most = self.most.max((mean + spread).min(surely));
            std::mem::swap(&mut self.start, &mut self.end);
            (from, width) = (to, 2.0 * width);
        }
    }

    /// Places everything at `end` as it is at a share of the current piece.
    fn place(&mut self, u: f64) {
        self.q.iter_mut().zip(&self.cubics).for_each(|(x, cubic)| *x = cubic.at(u));
        normalise_quaternions(&self.robot.space, &mut self.q);
        self.kinematics.forward(&self.q, &mut self.end);
        self.kinematics.carry(&self.q, self.rigid_attachments, &mut self.end);
    }
}

fn at(point: &WeightedPoint, X_WJ: &[Pose]) -> DVec3 {
    point.body.map_or(point.point, |body| X_WJ[body.at()].transform_point(point.point))
}
