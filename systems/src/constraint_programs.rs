//! Compiles what the graph demands into what the kernels solve: one program per leg, and one per state for motions in it.
//!
//! Along a leg every object hangs on something: a gripper, or the world where it lies. Those poses are right-hand sides,
//! so they are arguments; nothing of a leaf is ever written into a program. Argument slots, in order: one pose per object
//! in its carrier; one pose per further grasp of an object that is carried already (handle in gripper); one pose for the
//! drawn row of a crossed transition.

use crate::model::{Model, solid_grasp};
use foliate_components::Pose;
use foliate_components::candidate::LegParameter;
use foliate_components::constraint::{Constraint, Frame, Reference, RelativePose};
use foliate_components::graph::{ConstraintId, ConstraintKind, StateId, TransitionId};
use foliate_components::leaf::{LeafIndex, Parameter, ParameterId};
use foliate_components::robot::{JointIndex, Source};
use foliate_kernels::projection::{CarriageTemplate, CompileError, ConstraintProgram};
use glam::DVec3;

/// A compiled leg, or the compiled interior of a state.
#[derive(Clone, Debug)]
pub struct LegProgram {
    /// What the kernels solve.
    pub program: ConstraintProgram,
    /// Numbers of a configuration that the target does not depend on: joints of limbs that have nothing to do with it.
    pub idle: Vec<usize>,
    /// What each argument after the objects' poses is.
    extra: Vec<Extra>,
}

/// An argument after the objects' poses.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Extra {
    /// The handle in the gripper, for a further grasp of an object that is carried already.
    Hold(ConstraintId),
    /// The drawn value of this target constraint.
    Drawn(ConstraintId),
}

/// Constraints, carriages and arguments while they are collected.
struct Draft<'a> {
    model: &'a Model,
    state: StateId,
    constraints: Vec<Constraint>,
    extra: Vec<Extra>,
    /// Bodies that the target looks at.
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
            draft.demand(target, leg.drawn.contains(&target));
        }
        draft.compile()
    }

    /// The program of motions within a state: only what the state demands beyond its carriers.
    ///
    /// # Errors
    /// As [`Self::of_leg`].
    pub fn of_state(model: &Model, state: StateId) -> Result<Self, CompileError> {
        Draft::new(model, state).compile()
    }

    /// The arguments of a solve: where the leaf has the objects, and the drawn value.
    #[must_use]
    pub fn arguments(
        &self,
        model: &Model,
        leaves: &LeafIndex,
        leg: StateId,
        parameters: &[LegParameter],
        drawn: Option<ParameterId>,
    ) -> Vec<Pose> {
        let value = |constraint| parameter_in(model, leaves, leg, parameters, constraint);
        let state = model.graph.state(leg);
        let objects = (0..model.objects().len()).map(|object| {
            let carried = model.carrier_of(state, object).and_then(value);
            carried.map_or(Pose::identity(), |parameter| parameter.carrier_from_object)
        });
        let extras = self.extra.iter().map(|extra| match *extra {
            Extra::Hold(grasp) => value(grasp).map_or(Pose::identity(), |p| handle_in_gripper(model, grasp, p)),
            Extra::Drawn(target) => drawn.map_or(Pose::identity(), |id| aim(model, target, leaves.parameter(id))),
        });
        objects.chain(extras).collect()
    }
}

/// The value that a leg's leaf gives a constraint, where the constraint foliates the leg's state.
#[must_use]
pub fn parameter_in<'a>(
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

/// The pose of the handle in the gripper where the object hangs on the gripper's body as `parameter` says.
fn handle_in_gripper(model: &Model, grasp: ConstraintId, parameter: &Parameter) -> Pose {
    let Some(grasp) = model.grasp(grasp) else { return Pose::identity() };
    let X_GC = grasp.gripper.joint_from_frame.inverse();
    X_GC * parameter.carrier_from_object * grasp.handle.joint_from_frame
}

/// The argument with which a target constraint leads to a drawn leaf: the handle in the gripper for grasps, the object in
/// the world for placements, lifted along the support's normal for pre-placements.
fn aim(model: &Model, target: ConstraintId, drawn: &Parameter) -> Pose {
    match model.graph.constraint(target).kind {
        ConstraintKind::Grasp { .. } | ConstraintKind::Pregrasp { .. } => handle_in_gripper(model, target, drawn),
        ConstraintKind::Placement { .. } | ConstraintKind::Rest { .. } => drawn.carrier_from_object,
        ConstraintKind::Preplacement { object } => {
            let up = support_normal(model, object as usize, &drawn.carrier_from_object);
            let lift = up * model.problem.graph.preplacement_distance;
            Pose::from_translation(lift) * drawn.carrier_from_object
        }
    }
}

/// The unit normal, pointing out, of the support on which an object at `X_WO` lies.
fn support_normal(model: &Model, object: usize, X_WO: &Pose) -> DVec3 {
    let object = &model.objects()[object];
    let Some(resting) = &object.resting else { return DVec3::Z };
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    X_WJ[object.root.at()] = *X_WO;
    resting.normal(&X_WJ)
}

impl<'a> Draft<'a> {
    /// What a state demands beyond its carriers: every further grasp of an object that is carried already.
    fn new(model: &'a Model, state: StateId) -> Self {
        let mut draft = Self { model, state, constraints: Vec::new(), extra: Vec::new(), involved: Vec::new() };
        let record = model.graph.state(state);
        let carriers: Vec<_> = (0..model.objects().len()).filter_map(|o| model.carrier_of(record, o)).collect();
        for &constraint in &record.manifold {
            if carriers.contains(&constraint) {
                continue;
            }
            let Some(grasp) = model.grasp(constraint) else { continue };
            let slot = model.objects().len() + draft.extra.len();
            if model.graph.constraint(constraint).foliates {
                draft.extra.push(Extra::Hold(constraint));
            }
            draft.constraints.push(Constraint::RelativePose(grasp.hold(slot)));
            draft.involved.extend([grasp.gripper.joint, draft.carrier_body(grasp.handle.joint)]);
        }
        draft
    }

    /// Adds a target constraint, with its parameter rows where it is drawn.
    fn demand(&mut self, target: ConstraintId, drawn: bool) {
        let model = self.model;
        let slot = model.objects().len() + self.extra.len();
        let kind = model.graph.constraint(target).kind;
        match kind {
            ConstraintKind::Grasp { .. } | ConstraintKind::Pregrasp { .. } => {
                let Some(grasp) = model.grasp(target) else { return };
                let approaching = matches!(kind, ConstraintKind::Pregrasp { .. });
                let free = if approaching { grasp.pregrasp() } else { grasp.constraint() };
                let rows = if drawn { RelativePose::rigid(free.a, free.b, Reference::Argument(slot)) } else { free };
                self.constraints.push(Constraint::RelativePose(rows));
                self.involved.extend([grasp.gripper.joint, self.carrier_body(grasp.handle.joint)]);
            }
            ConstraintKind::Placement { object }
            | ConstraintKind::Preplacement { object }
            | ConstraintKind::Rest { object } => {
                let object = &model.objects()[object as usize];
                self.involved.push(self.carrier_body(Some(object.root)));
                if drawn {
                    let (world, root) = (Frame::world(Pose::identity()), Frame::of_joint(object.root));
                    let rows = RelativePose::rigid(world, root, Reference::Argument(slot));
                    self.constraints.push(Constraint::RelativePose(rows));
                } else if let Some(resting) = &object.resting {
                    let lifted = matches!(kind, ConstraintKind::Preplacement { .. });
                    let lift = if lifted { model.problem.graph.preplacement_distance } else { 0.0 };
                    self.constraints.push(resting.constraint(lift));
                }
            }
        }
        if drawn {
            self.extra.push(Extra::Drawn(target));
        }
    }

    /// The body that moves an object in this state, or the body itself where it is no object.
    fn carrier_body(&self, body: Option<JointIndex>) -> Option<JointIndex> {
        let object = self.model.objects().iter().position(|o| Some(o.root) == body);
        let Some(object) = object else { return body };
        let carrier = self.model.carrier_of(self.model.graph.state(self.state), object)?;
        self.model.grasp(carrier)?.gripper.joint
    }

    fn compile(self) -> Result<LegProgram, CompileError> {
        let model = self.model;
        let record = model.graph.state(self.state);
        let carriages: Vec<_> = (0..model.objects().len())
            .filter_map(|object| {
                let root = model.objects()[object].root;
                let constraint = model.carrier_of(record, object)?;
                let foliates = model.graph.constraint(constraint).foliates;
                Some(match model.grasp(constraint) {
                    Some(grasp) if !foliates => {
                        let (carrier, X_CO) = solid_grasp(grasp);
                        CarriageTemplate::fixed(root, carrier, X_CO)
                    }
                    Some(grasp) => CarriageTemplate::argument(root, grasp.gripper.joint, object),
                    None => CarriageTemplate::argument(root, None, object),
                })
            })
            .collect();
        let robot = &model.problem.robot;
        let locked = &model.problem.graph.locked;
        let program = ConstraintProgram::compile(robot, &model.kinematics, &self.constraints, &carriages, locked)?;
        let idle = idle_coordinates(model, &self.involved);
        Ok(LegProgram { program, idle, extra: self.extra })
    }
}

/// Numbers of the joints on which none of the involved bodies hangs; none where nothing is involved.
fn idle_coordinates(model: &Model, involved: &[Option<JointIndex>]) -> Vec<usize> {
    if involved.is_empty() {
        return Vec::new();
    }
    let joints = &model.problem.robot.joints;
    let mut moves = vec![false; joints.len()];
    for &body in involved {
        for joint in std::iter::successors(body, |j| joints[j.at()].parent) {
            moves[joint.at()] = true;
            if let Source::Follows { leader, .. } = joints[joint.at()].source {
                moves[leader.at()] = true;
            }
        }
    }
    let objects: Vec<_> = model.objects().iter().map(|o| o.root.at()).collect();
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
