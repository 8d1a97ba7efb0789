//! A configuration moved onto a state that is near.
//!
//! The poses of objects are corrected first, with all joints where sensors have them. Only where no poses of objects do it are joints
//! moved too: two hands that hold one object, the handle of a door, a joint that has to stand at a value.

use crate::planning_model::graph::snapping::nearby::{Nearby, ON};
use crate::planning_model::graph::states::state_keys::StateKey;
use crate::planning_model::graph::support_placement::{PlacementOnSupport, SupportPlacement};
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Reference, RelativePose};
use foliate_components::graph::ConstraintKind;
use foliate_components::pose::{log_so3, pose_from_array};
use foliate_components::robot::{JointIndex, JointType, Source};
use foliate_kernels::constrained_motion::{ConstraintProgram, Outcome, Scratch, Settings, project};
use foliate_kernels::constraints::placement;

/// How exactly a corrected configuration lies in its state, metres and radians.
const EXACT: f64 = 1e-9;
/// Newton steps to it.
const ITERATIONS: u32 = 60;
/// What is moved by less has its value by rounding.
const STILL: f64 = 1e-9;

/// A configuration in a state, and what was moved to get there.
#[derive(Clone, Debug)]
pub(super) struct Corrected {
    pub q: Vec<f64>,
    /// The joints that were moved, roots of objects included: metres and radians.
    pub moved: Vec<(JointIndex, f64, f64)>,
    /// The root of the sum of the squares of their shares of the tolerance.
    pub cost: f64,
}

impl Nearby<'_> {
    /// A configuration moved into a state, nothing by more than `factor` times the tolerance. `None` where that is not found.
    pub fn corrected(&self, state: &StateKey, q: &[f64], factor: f64) -> Option<Corrected> {
        let manifold: Vec<_> = self.manifold(state);
        let constraints: Vec<Constraint> = manifold.iter().filter_map(|&kind| self.constraint(kind)).collect();
        let roots: Vec<JointIndex> = self.roots().map(|(_, root)| root).collect();
        let holds = |there: &Corrected| {
            let X_WJ = self.poses(&there.q);
            manifold.iter().all(|&kind| self.residual(kind, &there.q, &X_WJ) <= ON)
        };
        let mut over = q.to_vec();
        for &kind in &manifold {
            if let ConstraintKind::Placement { object, on } = kind {
                self.slide(object as usize, self.place(object, on), &mut over);
            }
        }
        let objects = self.solved(&constraints, &over, &|joint| roots.contains(&joint));
        let within = |there: Vec<f64>| {
            let there = self.difference(q, there);
            let share = |&(_, distance, angle): &(_, f64, f64)| self.share(distance, angle);
            let is_within = there.moved.iter().map(share).fold(0.0, f64::max) <= factor * (1.0 + 1e-9);
            (is_within && holds(&there)).then_some(there)
        };
        objects.and_then(within).or_else(|| within(self.solved(&constraints, q, &|_| true)?))
    }

    /// Moves an object that hangs over the edge of a support by the shortest way: Newton's method would go towards the middle.
    pub fn slide(&self, object: usize, place: Option<&PlacementOnSupport>, q: &mut [f64]) {
        let Some(SupportPlacement::Surfaces(lying)) = place.map(|place| &place.resting) else { return };
        let Some((_, root)) = self.roots().find(|(number, _)| *number == object) else { return };
        let joint = &self.problem.robot.joints[root.at()];
        let X_WJ = self.poses(q);
        let way = placement::way_inside(lying, placement::contact(lying, &X_WJ), &X_WJ);
        if let (Some(way), Source::Coordinates { q: first, .. }, None) = (way, joint.source, joint.parent) {
            let way = joint.parent_from_joint.rotation.conjugate() * way;
            q[first..first + 3].iter_mut().zip(way.to_array()).for_each(|(q, by)| *q += by);
        }
    }

    /// A motion as a share of the tolerance. Where nothing may be moved, of the usual one: to compare states in messages.
    pub fn share(&self, distance: f64, angle: f64) -> f64 {
        let tolerance = self.problem.start_tolerance;
        let tolerance = if tolerance.is_none() { Default::default() } else { tolerance };
        tolerance.share(distance, angle)
    }

    /// Moves the free joints, by as little as Newton's method does, until the constraints hold.
    pub fn solved(
        &self,
        constraints: &[Constraint],
        q: &[f64],
        is_free: &dyn Fn(JointIndex) -> bool,
    ) -> Option<Vec<f64>> {
        let (robot, X_WJ) = (&self.problem.robot, self.poses(q));
        let mut locked = self.problem.graph.locked.clone();
        let mut constraints = constraints.to_vec();
        for (index, joint) in (0u32..).map(JointIndex).zip(&robot.joints) {
            let Source::Coordinates { q: first, .. } = joint.source else { continue };
            if is_free(index) || locked.iter().any(|(locked, _)| *locked == index) {
                continue;
            }
            match joint.motion.configuration_size() {
                1 => locked.push((index, q[first])),
                // What has several numbers stands where it is by a constraint.
                _ => {
                    let a = Frame { joint: joint.parent, joint_from_frame: joint.parent_from_joint };
                    let X_WA = a.joint.map_or(Pose::identity(), |parent| X_WJ[parent.at()]) * a.joint_from_frame;
                    let here = Reference::Fixed(X_WA.inverse() * X_WJ[index.at()]);
                    let stays = RelativePose::rigid(a, Frame::of_joint(index), here);
                    constraints.push(Constraint::RelativePose(stays));
                }
            }
        }
        let settings = Settings { tolerance: EXACT, iterations: ITERATIONS, ..Settings::default() };
        loop {
            let program = ConstraintProgram::compile(robot, self.kinematics, &constraints, &[], &locked).ok()?;
            let mut there = q.to_vec();
            match project(&program, &mut there, &[], &settings, &mut Scratch::default()) {
                Outcome::Converged { .. } => return Some(there),
                // What nothing can change need only hold as nearly as a start has to.
                Outcome::Contradicted { constraint, residual } if residual <= ON && constraint < constraints.len() => {
                    constraints.remove(constraint);
                }
                _ => return None,
            }
        }
    }

    /// What differs from `q`; numbers that differ by rounding alone are those of `q`.
    fn difference(&self, q: &[f64], mut there: Vec<f64>) -> Corrected {
        let mut moved = Vec::new();
        for (index, joint) in (0u32..).map(JointIndex).zip(&self.problem.robot.joints) {
            let Source::Coordinates { q: first, .. } = joint.source else { continue };
            let numbers = first..first + joint.motion.configuration_size();
            let (distance, angle) = apart(joint.motion, &q[numbers.clone()], &there[numbers.clone()]);
            if distance <= STILL && angle <= STILL {
                there[numbers.clone()].copy_from_slice(&q[numbers]);
            } else {
                moved.push((index, distance, angle));
            }
        }
        let squares = moved.iter().map(|&(_, distance, angle)| self.share(distance, angle).powi(2));
        let cost = squares.sum::<f64>().sqrt();
        Corrected { q: there, moved, cost }
    }
}

/// How far two values of a joint are apart: metres, radians.
pub(super) fn apart(motion: JointType, from: &[f64], to: &[f64]) -> (f64, f64) {
    let off = |i: usize| to[i] - from[i];
    match motion {
        JointType::Revolute { .. } => (0.0, off(0).abs()),
        JointType::Prismatic { .. } => (off(0).abs(), 0.0),
        JointType::Planar => (off(0).hypot(off(1)), off(2).abs()),
        JointType::FreeFlyer => {
            let read = |numbers: &[f64]| numbers.try_into().ok().and_then(pose_from_array).unwrap_or_default();
            poses_apart(&read(from), &read(to))
        }
    }
}

/// How far two poses are apart: the way of the origin, metres, and the angle of the turn, radians.
pub(super) fn poses_apart(from: &Pose, to: &Pose) -> (f64, f64) {
    let turn = log_so3(from.rotation.conjugate() * to.rotation).length();
    (from.translation.distance(to.translation), turn)
}
