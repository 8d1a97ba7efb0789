//! What carries each object, how it is attached there, and where that puts it.

use crate::planning_model::graph::attachment_order::{Carriers, is_rigid, solid_grasp};
use crate::planning_model::graph::support_placement::SupportPlacement;
use crate::planning_model::model::Model;
use crate::planning_model::state_classification;
use foliate_components::Pose;
use foliate_components::candidate::{LegParameter, PlannedLeg};
use foliate_components::constraint::{Constraint, Locked, LockedValue};
use foliate_components::graph::leaf::{Leaf, LeafIndex, Parameter};
use foliate_components::graph::{ConstraintId, ConstraintKind, StateId};
use foliate_components::path::Attachment;
use foliate_components::pose::{log_so3, pose_to_array};
use foliate_components::robot::{JointIndex, PartIndex, Robot, Source, SurfaceIndex};
use foliate_kernels::kinematics::RigidAttachment;

/// The value that a leg's leaf gives a constraint, where the constraint foliates the leg's state.
#[must_use]
pub(crate) fn parameter_in<'a>(
    model: &Model,
    leaves: &'a LeafIndex,
    state: StateId,
    parameters: &'a [LegParameter],
    constraint: ConstraintId,
) -> Option<&'a Parameter> {
    let position = model.graph.state(state).foliation.iter().position(|&c| c == constraint)?;
    match &parameters[position] {
        LegParameter::Known(id) => Some(leaves.parameter(*id)),
        LegParameter::Fresh(value) => Some(value),
    }
}

impl Model {
    /// What carries each object in a state.
    #[must_use]
    pub fn carriers(&self, state: StateId) -> &Carriers {
        self.states[state.at()].carriers.get_or_init(|| {
            let manifold = &self.graph.state(state).manifold;
            let grasp = |constraint| self.grasp(constraint);
            Box::new(Carriers::of_manifold(&self.problem.robot, &self.graph, manifold, grasp))
        })
    }

    /// The object that a grasp holds by its root, or that a placement or rest is about.
    #[must_use]
    pub fn object_of(&self, constraint: ConstraintId) -> Option<usize> {
        match self.graph.constraint(constraint).kind {
            ConstraintKind::Placement { object, .. }
            | ConstraintKind::Preplacement { object, .. }
            | ConstraintKind::Rest { object } => Some(object as usize),
            ConstraintKind::Grasp { handle, .. } | ConstraintKind::Pregrasp { handle, .. } => {
                self.graph.objects.iter().position(|o| o.handles.contains(&handle))
            }
            ConstraintKind::JointRest { .. }
            | ConstraintKind::Finger { .. }
            | ConstraintKind::Given { .. }
            | ConstraintKind::Approach { .. }
            | ConstraintKind::Lift { .. }
            | ConstraintKind::WhileHeld { .. } => None,
        }
    }

    /// Whether a grasp determines the pose of the object's root.
    #[must_use]
    pub fn holds_rigidly(&self, constraint: ConstraintId) -> bool {
        let root = self.object_of(constraint).and_then(|object| self.objects[object].root);
        self.grasp(constraint).is_some_and(|grasp| is_rigid(grasp, root))
    }

    /// How every object is attached to what carries it, in a state whose foliating constraints have the values `parameter`; a
    /// carrier comes before what it carries.
    pub fn rigid_attachments<'a>(
        &self,
        state: StateId,
        parameter: impl Fn(ConstraintId) -> Option<&'a Parameter>,
    ) -> Vec<RigidAttachment> {
        let carriers = self.carriers(state);
        let rigid_attachment = |&index: &usize| {
            let (constraint, object) = (carriers.of[index]?, self.objects[index].root?);
            if let Some(value) = parameter(constraint) {
                return Some(RigidAttachment { object, carrier: value.carrier, X_CO: value.value });
            }
            let (carrier, X_CO) = solid_grasp(self.grasp(constraint)?);
            Some(RigidAttachment { object, carrier, X_CO })
        };
        carriers.order.iter().filter_map(rigid_attachment).collect()
    }

    /// How every object is attached to what carries it, on a leaf.
    #[must_use]
    pub fn attachments_of_leaf(&self, leaf: &Leaf, leaves: &LeafIndex) -> Vec<RigidAttachment> {
        let foliation = &self.graph.state(leaf.state).foliation;
        self.rigid_attachments(leaf.state, |constraint| {
            let position = foliation.iter().position(|&c| c == constraint)?;
            Some(leaves.parameter(leaf.parameters[position]))
        })
    }

    /// How every object is attached to what carries it, along a leg.
    #[must_use]
    pub fn attachments_of_leg(&self, leg: &PlannedLeg, leaves: &LeafIndex) -> Vec<RigidAttachment> {
        self.rigid_attachments(leg.state, |constraint| {
            parameter_in(self, leaves, leg.state, &leg.parameters, constraint)
        })
    }

    /// What every object is attached to, on a leaf, for output; an object's carrier comes first.
    #[must_use]
    pub fn attachments(&self, leaf: &Leaf, leaves: &LeafIndex) -> Vec<Attachment> {
        let state = self.graph.state(leaf.state);
        let carriers = self.carriers(leaf.state);
        let mut attachments = Vec::new();
        for (index, object) in self.objects.iter().enumerate() {
            let first = attachments.len();
            for &constraint in &state.manifold {
                if self.object_of(constraint) != Some(index) {
                    continue;
                }
                let carrier = carriers.of[index] == Some(constraint);
                let attachment = match self.graph.constraint(constraint).kind {
                    ConstraintKind::Grasp { gripper, handle } => {
                        let held = self.problem.robot.links[self.problem.robot.handles[handle.at()].link.at()].joint;
                        let object = object.root.or(held);
                        object.map(|object| Attachment::Grasp { object, gripper, handle, carrier })
                    }
                    ConstraintKind::Placement { on, .. } => self.contact(leaf, leaves, constraint, index, on),
                    ConstraintKind::Rest { .. } => object.root.map(|object| Attachment::Rest { object, on: None }),
                    _ => None,
                };
                match attachment {
                    Some(attachment) if carrier => attachments.insert(first, attachment),
                    Some(attachment) => attachments.push(attachment),
                    None => {}
                }
            }
        }
        attachments
    }

    /// Which surfaces touch where an object lies on a leaf.
    fn contact(
        &self,
        leaf: &Leaf,
        leaves: &LeafIndex,
        constraint: ConstraintId,
        object: usize,
        on: Option<JointIndex>,
    ) -> Option<Attachment> {
        let position = self.graph.state(leaf.state).foliation.iter().position(|&c| c == constraint)?;
        let parameter = leaves.parameter(leaf.parameters[position]);
        let root = self.objects[object].root?;
        let place = self.objects[object].placement_on(on)?;
        let SupportPlacement::Surfaces(lying) = &place.resting else {
            return Some(Attachment::Rest { object: root, on: place.touches });
        };
        // Seen from the carrier, which stands at the origin.
        let mut X_WJ = vec![Pose::identity(); self.kinematics.bodies()];
        X_WJ[root.at()] = parameter.value;
        let touching = foliate_kernels::constraints::placement::contact(lying, &X_WJ);
        let surface = numbered(&self.problem.robot, &self.graph.objects[object].surfaces, touching.object)?;
        let support = numbered(&self.problem.robot, &place.supports, touching.support)?;
        Some(Attachment::Contact { object: root, surface, support })
    }

    /// How far the objects' coordinates in the knots of a motion are from where their carriers take them: at the joint
    /// knots of two segments an object has the next leaf's exact pose. And how far what carries them is from holding: by as
    /// much as the start or goal is, where a leaf has its values from there.
    #[must_use]
    pub fn carrier_gap(&self, leaf: &Leaf, leaves: &LeafIndex, knots: &[Vec<f64>]) -> CarrierGap {
        self.gap_along(leaf.state, &self.attachments_of_leaf(leaf, leaves), knots)
    }

    /// As [`Self::carrier_gap`], of a state whose objects are attached like this.
    pub(crate) fn gap_along(
        &self,
        state: StateId,
        rigid_attachments: &[RigidAttachment],
        knots: &[Vec<f64>],
    ) -> CarrierGap {
        let carrying = || self.carriers(state).of.iter().flatten();
        let mut X_WJ = vec![Pose::identity(); self.kinematics.bodies()];
        let mut gap = CarrierGap::default();
        // A position and a rotation have three rows each: their errors are at most √3 times the largest row.
        let off = |q: &[f64], X_WJ: &[Pose]| {
            let largest = carrying().map(|&constraint| state_classification::residual(self, constraint, q, X_WJ));
            3.0_f64.sqrt() * largest.fold(0.0, f64::max)
        };
        for q in knots {
            self.kinematics.forward(q, &mut X_WJ);
            // Where an object is written its handle may be off by more than its origin.
            gap.residual = gap.residual.max(off(q, &X_WJ));
            let written: Vec<Pose> = rigid_attachments.iter().map(|c| X_WJ[c.object.at()]).collect();
            self.kinematics.carry(q, rigid_attachments, &mut X_WJ);
            for (rigid_attachment, written) in rigid_attachments.iter().zip(written) {
                let carried = X_WJ[rigid_attachment.object.at()];
                let turn = log_so3(written.rotation.conjugate() * carried.rotation).length();
                let shift = carried.translation.distance(written.translation);
                gap.written = gap.written.max(shift).max(turn);
                gap.moved = gap.moved.max(shift + turn * self.reach_of(rigid_attachment.object));
            }
            gap.residual = gap.residual.max(off(q, &X_WJ));
        }
        gap.residual = gap.residual.max(gap.written);
        gap
    }

    /// How far an object reaches from its root, metres.
    fn reach_of(&self, object: JointIndex) -> f64 {
        match self.problem.robot.joints[object.at()].source {
            Source::Coordinates { v, .. } => self.weights.get(v + 3).copied().unwrap_or(f64::INFINITY),
            Source::Follows { .. } => f64::INFINITY,
        }
    }

    /// Whether an object is outside the bounds of its coordinates.
    #[must_use]
    pub fn object_out_of_bounds(&self, q: &[f64]) -> bool {
        let space = &self.problem.robot.space;
        self.objects.iter().filter_map(|object| object.root).any(|root| {
            match self.problem.robot.joints[root.at()].source {
                Source::Coordinates { q: first, .. } => {
                    (first..first + 3).any(|i| !(q[i] >= space.lower[i] - 1e-9 && q[i] <= space.upper[i] + 1e-9))
                }
                Source::Follows { .. } => false,
            }
        })
    }

    /// Puts the movable objects of `q` where `poses` say, or else where `start` has them, their joints included.
    pub fn place_objects(&self, start: &[f64], poses: &[(PartIndex, Pose)], q: &mut [f64]) {
        let joints = &self.problem.robot.joints;
        for (record, object) in self.graph.objects.iter().zip(&self.objects) {
            for joint in &joints[self.problem.robot.parts[record.part.at()].joints.clone()] {
                if let Source::Coordinates { q: first, .. } = joint.source {
                    let numbers = first..first + joint.motion.configuration_size();
                    q[numbers.clone()].copy_from_slice(&start[numbers]);
                }
            }
            let pose = poses.iter().find(|(part, _)| *part == record.part).map(|(_, pose)| pose_to_array(pose));
            if let (Some(numbers), Some(root)) = (pose, object.root)
                && let Source::Coordinates { q: first, .. } = joints[root.at()].source
            {
                q[first..first + 7].copy_from_slice(&numbers);
            }
        }
    }

    /// Sets joints that are at rest in a state to the value at which they rest, and fingers to their opening there; joints that stay
    /// where they were left keep theirs.
    pub fn rest(&self, state: StateId, q: &mut [f64]) {
        for &constraint in &self.graph.state(state).manifold {
            let kind = self.graph.constraint(constraint).kind;
            if matches!(kind, ConstraintKind::JointRest { .. } | ConstraintKind::Finger { .. })
                && let Some(Constraint::Locked(Locked { joint, value: LockedValue::Fixed(value) })) =
                    self.constraint(constraint)
                && let Source::Coordinates { q: coordinate, .. } = self.problem.robot.joints[joint.at()].source
            {
                q[coordinate] = value;
            }
        }
    }
}

/// How far a motion as it is written is from the leaf that it lies on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CarrierGap {
    /// Of objects and what carries them: the largest error of a position or a rotation, metres and radians.
    pub residual: f64,
    /// Of objects as they are written and where their carriers take them: the largest difference, metres and radians.
    pub written: f64,
    /// At most this far is any point of an object from where its carrier takes it, metres.
    pub moved: f64,
}

/// The surface and the number in it of the `count`-th polygon of some surfaces.
fn numbered(robot: &Robot, surfaces: &[SurfaceIndex], mut count: usize) -> Option<(SurfaceIndex, u32)> {
    for &surface in surfaces {
        let polygons = robot.surfaces[surface.at()].polygons.len();
        if count < polygons {
            return Some((surface, count as u32));
        }
        count -= polygons;
    }
    None
}
