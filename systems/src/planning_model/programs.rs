//! Compiles constraints of the graph into what the kernels solve: one program per leg, and one per state for motions in it.
//!
//! Along a leg every object is attached to something: a gripper, or the body on which it lies. Those poses are right-hand sides,
//! so they are arguments; nothing of a leaf is ever written into a program. Argument slots, in order: one pose per object
//! in its carrier; one per further constraint of the state that has parameters (a second hand's grasp, a door that stays
//! where it was left, a foot that stands); one per drawn target of a crossed transition.

use crate::planning_model::attachments::parameter_in;
use crate::planning_model::graph::attachment_order::solid_grasp;
use crate::planning_model::graph::transitions::led_to;
use crate::planning_model::leg_program::{Extra, LegProgram};
use crate::planning_model::model::Model;
use foliate_components::Pose;
use foliate_components::candidate::LegParameter;
use foliate_components::constraint::{Constraint, Frame, Reference, RelativePose, rows};
use foliate_components::graph::leaf::{LeafId, LeafIndex, Parameter};
use foliate_components::graph::{ConstraintId, ConstraintKind, StateId, TransitionId};
use foliate_components::robot::{JointIndex, Source};
use foliate_kernels::constrained_motion::{AttachmentTemplate, CompileError, ConstraintProgram};
use glam::DVec3;

/// Constraints, rigid attachments and arguments while they are collected.
struct Draft<'a> {
    model: &'a Model,
    state: StateId,
    constraints: Vec<Constraint>,
    extra: Vec<Extra>,
    /// Bodies that the target depends on.
    involved: Vec<Option<JointIndex>>,
}

impl LegProgram {
    /// The program of a transition's leg: on the leg's leaf, and on its target.
    ///
    /// # Errors
    /// Constraints that make no program; a graph that was built by hand can ask for such.
    pub fn of_leg(model: &Model, transition: TransitionId, leg: usize) -> Result<Self, CompileError> {
        let leg = &model.graph.transition(transition).legs[leg];
        let mut draft = Draft::new(model, leg.state);
        for &target in &leg.target {
            draft.require(target, leg.drawn.contains(&target));
        }
        draft.compile()
    }

    /// The program of motions within a state: only what the state requires beyond its carriers.
    ///
    /// # Errors
    /// As [`Self::of_leg`].
    pub fn of_state(model: &Model, state: StateId) -> Result<Self, CompileError> {
        Draft::new(model, state).compile()
    }

    /// The arguments of a solve: where the leaf has the objects, and what is drawn of the leaf that is aimed at.
    #[must_use]
    pub fn arguments(
        &self,
        model: &Model,
        leaves: &LeafIndex,
        leg: StateId,
        parameters: &[LegParameter],
        drawn: Option<LeafId>,
    ) -> Vec<Pose> {
        let value = |constraint| parameter_in(model, leaves, leg, parameters, constraint);
        let carriers = &model.carriers(leg).of;
        let objects = carriers.iter().map(|&carrier| {
            let carried = carrier.and_then(value);
            carried.map_or(Pose::identity(), |parameter| parameter.value)
        });
        let extras = self.extra.iter().map(|extra| match *extra {
            Extra::Hold(constraint) => {
                value(constraint).map_or(Pose::identity(), |p| argument_of(model, constraint, p))
            }
            Extra::Drawn(target) => drawn
                .and_then(|leaf| drawn_value(model, leaves, leaf, target))
                .map_or(Pose::identity(), |p| aim(model, target, p)),
        });
        objects.chain(extras).collect()
    }
}

/// The value to which a waypoint's constraint leads on a drawn leaf.
fn drawn_value<'a>(model: &Model, leaves: &'a LeafIndex, drawn: LeafId, target: ConstraintId) -> Option<&'a Parameter> {
    let leaf = leaves.leaf(drawn);
    let wanted = led_to(model.graph.constraint(target).kind);
    let foliation = &model.graph.state(leaf.state).foliation;
    let position = foliation.iter().position(|&c| model.graph.constraint(c).kind == wanted)?;
    Some(leaves.parameter(leaf.parameters[position]))
}

/// The argument of a constraint's rows: for grasps the pose of the handle in the gripper.
fn argument_of(model: &Model, constraint: ConstraintId, parameter: &Parameter) -> Pose {
    let Some(grasp) = model.grasp(constraint) else { return parameter.value };
    if !model.holds_rigidly(constraint) {
        return parameter.value;
    }
    let X_GC = grasp.gripper.joint_from_frame.inverse();
    X_GC * parameter.value * grasp.handle.joint_from_frame
}

/// The argument with which a target constraint leads to a drawn leaf: for placements the object in its carrier, lifted
/// along the support's normal for pre-placements.
fn aim(model: &Model, target: ConstraintId, drawn: &Parameter) -> Pose {
    match model.graph.constraint(target).kind {
        ConstraintKind::Preplacement { object, on } => {
            let up = support_normal(model, object as usize, on, &drawn.value);
            let lift = up * model.problem.graph.preplacement_distance;
            Pose::from_translation(lift) * drawn.value
        }
        _ => argument_of(model, target, drawn),
    }
}

/// The unit normal, pointing out, of the support on which an object lies at `X_CO`; both in the carrier's joint frame.
fn support_normal(model: &Model, object: usize, on: Option<JointIndex>, X_CO: &Pose) -> DVec3 {
    let object = &model.objects()[object];
    let (Some(place), Some(root)) = (object.placement_on(on), object.root) else { return DVec3::Z };
    // The carrier stands at the origin.
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    X_WJ[root.at()] = *X_CO;
    place.resting.normal(&X_WJ)
}

impl<'a> Draft<'a> {
    /// What a state requires beyond its carriers: further grasps of what is carried already, grasps of doors, joints at
    /// rest, constraints of the problem's own.
    fn new(model: &'a Model, state: StateId) -> Self {
        let mut draft = Self { model, state, constraints: Vec::new(), extra: Vec::new(), involved: Vec::new() };
        let carriers = &model.carriers(state).of;
        for &constraint in &model.graph.state(state).manifold {
            if carriers.contains(&Some(constraint)) {
                continue;
            }
            let slot = draft.next_slot();
            let rows = match model.grasp(constraint) {
                Some(grasp) => Some(Constraint::RelativePose(grasp.hold(slot))),
                None => model.constraint(constraint).map(|constraint| constraint.at_slot(slot)),
            };
            let Some(rows) = rows else { continue };
            if model.graph.constraint(constraint).foliates {
                draft.extra.push(Extra::Hold(constraint));
            }
            draft.push(rows);
        }
        draft
    }

    /// Where the next argument goes.
    fn next_slot(&self) -> usize {
        self.model.objects().len() + self.extra.len()
    }

    fn push(&mut self, constraint: Constraint) {
        self.involved.extend(constraint.bodies());
        self.constraints.push(constraint);
    }

    /// Adds a target constraint, with its parameter rows where it is drawn.
    fn require(&mut self, target: ConstraintId, drawn: bool) {
        if let Some(constraint) = self.target(target, drawn) {
            self.push(constraint);
        }
        if drawn {
            self.extra.push(Extra::Drawn(target));
        }
    }

    /// A target constraint as rows; none where it asks for nothing.
    fn target(&self, target: ConstraintId, drawn: bool) -> Option<Constraint> {
        let (model, slot) = (self.model, self.next_slot());
        let kind = model.graph.constraint(target).kind;
        match kind {
            ConstraintKind::Grasp { .. } | ConstraintKind::Pregrasp { .. } => {
                let grasp = model.grasp(target)?;
                let approaching = matches!(kind, ConstraintKind::Pregrasp { .. });
                let free = if approaching { grasp.pregrasp() } else { grasp.constraint() };
                let hold = RelativePose {
                    rows: rows(grasp.mask, grasp.complement),
                    reference: Reference::Argument(slot),
                    ..free
                };
                Some(Constraint::RelativePose(if drawn { hold } else { free }))
            }
            ConstraintKind::Placement { object, on } | ConstraintKind::Preplacement { object, on } => {
                let object = &model.objects()[object as usize];
                if drawn {
                    return Some(held_at(on, object.root?, slot));
                }
                let lifted = matches!(kind, ConstraintKind::Preplacement { .. });
                let lift = if lifted { model.problem.graph.preplacement_distance } else { 0.0 };
                Some(object.placement_on(on)?.resting.constraint(lift))
            }
            ConstraintKind::Rest { object } => {
                let root = model.objects()[object as usize].root?;
                drawn.then(|| held_at(None, root, slot))
            }
            ConstraintKind::JointRest { .. }
            | ConstraintKind::Finger { .. }
            | ConstraintKind::Given { .. }
            | ConstraintKind::Approach { .. }
            | ConstraintKind::Lift { .. }
            | ConstraintKind::WhileHeld { .. } => {
                let constraint = model.constraint(target)?;
                if drawn { Some(constraint.at_slot(slot)) } else { constraint.without_parameters() }
            }
        }
    }

    fn compile(self) -> Result<LegProgram, CompileError> {
        let model = self.model;
        let carriers = model.carriers(self.state);
        let rigid_attachment = |&object: &usize| {
            let (root, constraint) = (model.objects()[object].root?, carriers.of[object]?);
            let foliates = model.graph.constraint(constraint).foliates;
            Some(match (model.grasp(constraint), model.graph.constraint(constraint).kind) {
                (Some(grasp), _) if !foliates => {
                    let (carrier, X_CO) = solid_grasp(grasp);
                    AttachmentTemplate::fixed(root, carrier, X_CO)
                }
                (Some(grasp), _) => AttachmentTemplate::argument(root, grasp.gripper.joint, object),
                (None, ConstraintKind::Placement { on, .. }) => AttachmentTemplate::argument(root, on, object),
                (None, _) => AttachmentTemplate::argument(root, None, object),
            })
        };
        let rigid_attachments: Vec<_> = carriers.order.iter().filter_map(rigid_attachment).collect();
        let robot = &model.problem.robot;
        let locked = &model.problem.graph.locked;
        let program =
            ConstraintProgram::compile(robot, &model.kinematics, &self.constraints, &rigid_attachments, locked)?;
        let idle = idle_coordinates(model, &rigid_attachments, &self.involved);
        let frames = |constraint: &Constraint| match constraint {
            Constraint::RelativePose(pose) if pose.is_rigid() => Some((pose.a, pose.b)),
            _ => None,
        };
        let rigid = self.constraints.iter().filter_map(frames).collect();
        Ok(LegProgram { program, idle, rigid, extra: self.extra })
    }
}

/// An object at the argument in `slot` on a body.
fn held_at(on: Option<JointIndex>, root: JointIndex, slot: usize) -> Constraint {
    let carrier = on.map_or_else(|| Frame::world(Pose::identity()), Frame::of_joint);
    Constraint::RelativePose(RelativePose::rigid(carrier, Frame::of_joint(root), Reference::Argument(slot)))
}

/// Numbers of the joints that move none of the involved bodies; none where nothing is involved.
fn idle_coordinates(
    model: &Model,
    rigid_attachments: &[AttachmentTemplate],
    involved: &[Option<JointIndex>],
) -> Vec<usize> {
    if involved.is_empty() {
        return Vec::new();
    }
    let joints = &model.problem.robot.joints;
    let mut moves = vec![false; joints.len()];
    let above = |joint: &JointIndex| match rigid_attachments
        .iter()
        .find(|rigid_attachment| rigid_attachment.object == *joint)
    {
        Some(rigid_attachment) => rigid_attachment.carrier,
        None => joints[joint.at()].parent,
    };
    for &body in involved {
        // Rigid attachments close no circle, so no chain is longer than the robot.
        for joint in std::iter::successors(body, above).take(joints.len()) {
            moves[joint.at()] = true;
            if let Source::Follows { leader, .. } = joints[joint.at()].source {
                moves[leader.at()] = true;
            }
        }
    }
    let objects: Vec<_> = model.objects().iter().filter_map(|o| o.root).map(JointIndex::at).collect();
    let mut idle = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        if let Source::Coordinates { q, .. } = joint.source
            && !moves[index]
            && !objects.contains(&index)
        {
            idle.extend(q..q + joint.motion.configuration_size());
        }
    }
    idle
}

impl Model {
    /// The program of a transition's leg.
    ///
    /// # Errors
    /// What a graph that was built by hand may ask for and no program can say.
    pub fn leg_program(&self, transition: TransitionId, leg: usize) -> Result<&LegProgram, &CompileError> {
        let program = &self.leg_tables(transition)[leg].program;
        program.get_or_init(|| Box::new(LegProgram::of_leg(self, transition, leg))).as_ref().as_ref()
    }

    /// The program of motions within a state.
    ///
    /// # Errors
    /// As [`Self::leg_program`].
    pub fn interior_program(&self, state: StateId) -> Result<&LegProgram, &CompileError> {
        let interior = &self.states[state.at()].interior;
        interior.get_or_init(|| Box::new(LegProgram::of_state(self, state))).as_ref().as_ref()
    }
}
