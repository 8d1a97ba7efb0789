//! Limits of the speed of objects that a gripper holds: a ceiling of the path velocity where times are found, and what the curve exceeds.

use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::Model;
use crate::trajectory::stretch::Stretch;
use foliate_components::Pose;
use foliate_components::constraint::Frame;
use foliate_components::robot::configuration::Group;
use foliate_components::robot::{HandleIndex, PartIndex};
use foliate_kernels::constrained_motion::curve_speed;
use foliate_kernels::constraints::placement_of;
use foliate_kernels::curve::HermiteCurve;
use foliate_kernels::kinematics::RigidAttachment;
use foliate_kernels::trajectory::Spline;
use glam::DVec3;
use std::cell::RefCell;

/// The share of a limit that is aimed at: a checker needs some room to decide.
const AIM: f64 = 0.998;
/// Places of an interval at which the speed along the path is measured.
const PLACES: usize = 5;
/// The share of an interval over which it is measured.
const NEAR: f64 = 1e-3;

/// The objects that are held along a stretch and have a limit.
pub(crate) struct HeldSpeed<'a> {
    model: &'a Model,
    rigid_attachments: &'a [RigidAttachment],
    /// The frame of the root link, and its largest speed, m/s.
    limits: Vec<(Frame, f64)>,
    buffers: RefCell<(Vec<f64>, Vec<Pose>)>,
}

impl<'a> HeldSpeed<'a> {
    pub(crate) fn of(model: &'a Model, motions: &'a [LeafMotion], stretch: &Stretch) -> Self {
        let (robot, motion) = (&model.problem.robot, &motions[stretch.motions.start]);
        let grasps = &model.graph.state(motion.state).grasps;
        let part_of = |handle: HandleIndex| robot.links[robot.handles[handle.at()].link.at()].part;
        let held = model.problem.timing.object_speed.iter();
        let held = held.filter(|(part, _)| grasps.iter().any(|&(_, handle)| part_of(handle) == *part));
        let frame = |part: PartIndex| Frame::on_link(robot, robot.parts[part.at()].root_link, &Pose::identity());
        Self {
            model,
            rigid_attachments: &motion.rigid_attachments,
            limits: held.map(|&(part, limit)| (frame(part), AIM * limit)).collect(),
            buffers: RefCell::new((vec![0.0; robot.space.size()], vec![Pose::identity(); model.kinematics.bodies()])),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.limits.is_empty()
    }

    /// The largest path velocity between two parameters of a path, as far as some places tell.
    pub(crate) fn ceiling(&self, path: &Spline, [from, to]: [f64; 2]) -> f64 {
        let near = NEAR * (to - from);
        let place = |k: usize| from + (to - from - near) * k as f64 / (PLACES - 1) as f64;
        let mut ceiling = f64::INFINITY;
        for (frame, limit) in &self.limits {
            for k in 0..PLACES {
                let way = self.origin(path, frame, place(k)).distance(self.origin(path, frame, place(k) + near));
                ceiling = ceiling.min(limit * near / way);
            }
        }
        // Standing still, or too short to tell.
        if ceiling > 0.0 { ceiling } else { f64::INFINITY }
    }

    fn origin(&self, path: &Spline, frame: &Frame, parameter: f64) -> DVec3 {
        let (q, X_WJ) = &mut *self.buffers.borrow_mut();
        path.position(parameter, q);
        for factor in &self.model.problem.robot.space.factors {
            if factor.group == Group::FreeFlyer {
                let numbers = &mut q[factor.q + 3..factor.q + 7];
                let length = numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
                numbers.iter_mut().for_each(|x| *x /= length);
            }
        }
        self.model.kinematics.forward(q, X_WJ);
        self.model.kinematics.carry(q, self.rigid_attachments, X_WJ);
        placement_of(frame).in_world(X_WJ).translation
    }

    /// By which factor a curve over time is too fast at most; at most 1 where it is not.
    pub(crate) fn share(&self, curve: &Spline) -> f64 {
        let knots: Vec<f64> = (0..curve.len()).flat_map(|knot| curve.knot(knot).iter().copied()).collect();
        let velocities: Vec<f64> = (0..curve.len()).flat_map(|knot| curve.velocity(knot).iter().copied()).collect();
        let curve = HermiteCurve { knots: &knots, velocities: &velocities, times: curve.parameters() };
        let share = |(frame, limit): &(Frame, f64)| {
            let (robot, kinematics) = (&self.model.problem.robot, &self.model.kinematics);
            curve_speed(robot, kinematics, self.rigid_attachments, frame, &curve, *limit) / limit
        };
        self.limits.iter().map(share).fold(0.0, f64::max)
    }
}
