//! The segments of a path in a form that can be changed: each a motion on one leaf, with what the leaf requires.

use crate::planning_model::model::Model;
use crate::planning_model::state_classification::{parameters_of, residual};
use foliate_components::Pose;
use foliate_components::candidate::LegParameter;
use foliate_components::graph::leaf::{Leaf, LeafIndex, Parameter};
use foliate_components::graph::{ConstraintId, Fingers, StateId, TransitionId, TransitionKind};
use foliate_components::path::{ManipulationPath, Segment};
use foliate_components::pose::log_so3;
use foliate_kernels::kinematics::RigidAttachment;

/// Values of foliating constraints that differ by less are of one leaf: metres and radians.
const SAME_LEAF: f64 = 1e-6;

/// A motion on one leaf.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafMotion {
    /// The transition that is travelled, in the direction of travel.
    pub transition: TransitionId,
    /// The state in which the motion lies.
    pub state: StateId,
    /// The values of the state's foliating constraints.
    pub parameters: Vec<Parameter>,
    /// What carries each object.
    pub rigid_attachments: Vec<RigidAttachment>,
    /// Right-hand sides of the implicit rows; empty where there are none.
    pub arguments: Vec<Pose>,
    /// Whether implicit rows keep the motion on its leaf. Its knots are dense then.
    pub is_implicit: bool,
    /// What the fingers of hands do. While those of one move nothing else of the robot does.
    pub fingers: Fingers,
    /// Whole configurations, end to end.
    pub knots: Vec<f64>,
    /// Proven bound of the residual of implicit rows, metres and radians.
    pub residual: f64,
    /// Whether its first knot is a waypoint of its transition on the leaf of the motion before, such as a pregrasp. The path has to
    /// pass waypoints.
    pub starts_at_waypoint: bool,
}

impl LeafMotion {
    /// The motions of a path. Motions that follow one another on one leaf become one, except at waypoints. `None` where a
    /// constraint of a state does not compile.
    #[must_use]
    pub fn of_path(model: &Model, path: &ManipulationPath) -> Option<Vec<Self>> {
        let mut motions: Vec<Self> = Vec::with_capacity(path.segments.len());
        for segment in &path.segments {
            let motion = Self { residual: path.certificate.max_residual, ..Self::of_segment(model, segment)? };
            let is_waypoint = |last: &Self| {
                last.is_on_leaf_of(&motion)
                    && is_waypoint(model, &segment.knots[0], [last.transition, motion.transition])
            };
            let starts_at_waypoint = motions.last().is_some_and(is_waypoint);
            motions.push(Self { starts_at_waypoint, ..motion });
        }
        Some(merged(model, motions))
    }

    pub(crate) fn of_segment(model: &Model, segment: &Segment) -> Option<Self> {
        let (q, state) = (segment.knots.first()?, segment.state);
        let X_WJ = model.kinematics.poses(q);
        let parameters = parameters_of(model, state, q, &X_WJ);
        let motion = Self {
            transition: segment.transition,
            state,
            parameters: Vec::new(),
            rigid_attachments: Vec::new(),
            arguments: Vec::new(),
            is_implicit: model.interior_program(state).ok()?.program.rows() > 0,
            fingers: model.graph.state(state).fingers,
            knots: segment.knots.concat(),
            residual: 0.0,
            starts_at_waypoint: false,
        };
        motion.on_leaf(model, parameters)
    }

    /// The same on another leaf of the state; knots stay as they are. `None` where a constraint of the state does not compile.
    pub(crate) fn on_leaf(self, model: &Model, parameters: Vec<Parameter>) -> Option<Self> {
        let value = |constraint| parameters.iter().find(|p| p.constraint == constraint);
        let rigid_attachments = model.rigid_attachments(self.state, value);
        let arguments = match self.is_implicit {
            true => interior_arguments(model, self.state, &parameters)?,
            false => Vec::new(),
        };
        Some(Self { parameters, rigid_attachments, arguments, ..self })
    }

    /// Whether another motion lies on the same leaf.
    #[must_use]
    pub fn is_on_leaf_of(&self, other: &Self) -> bool {
        self.state == other.state && self.has_parameters(&other.parameters)
    }

    /// Whether the leaf has these values of the state's foliating constraints.
    #[must_use]
    pub fn has_parameters(&self, parameters: &[Parameter]) -> bool {
        self.parameters.iter().zip(parameters).all(|(a, b)| same_value(a, b))
    }

    /// The first configuration.
    #[must_use]
    pub fn start(&self, size: usize) -> &[f64] {
        &self.knots[..size]
    }

    /// The last configuration.
    #[must_use]
    pub fn end(&self, size: usize) -> &[f64] {
        &self.knots[self.knots.len() - size..]
    }

    /// The motion that stands still at a configuration of the same leaf.
    #[must_use]
    pub fn standing_still(&self, q: &[f64]) -> Self {
        Self { knots: [q, q].concat(), residual: 0.0, ..self.clone() }
    }

    /// The leaf, in an index of its own.
    #[must_use]
    pub fn leaf(&self) -> (Leaf, LeafIndex) {
        let mut leaves = LeafIndex::default();
        let parameters = self.parameters.iter().map(|p| leaves.add_parameter(*p)).collect();
        (Leaf { state: self.state, parameters }, leaves)
    }

    /// The segment of a path.
    #[must_use]
    pub fn segment(&self, model: &Model) -> Segment {
        let (leaf, leaves) = self.leaf();
        Segment {
            transition: self.transition,
            state: self.state,
            attachments: model.attachments(&leaf, &leaves),
            constraints: model.path_constraints(&leaf, &leaves),
            knots: self.knots.chunks_exact(model.problem.robot.space.size()).map(<[f64]>::to_vec).collect(),
            timing: None,
        }
    }
}

/// Right-hand sides of a state's rows on a leaf. `None` where a constraint of the state does not compile.
pub(crate) fn interior_arguments(model: &Model, state: StateId, parameters: &[Parameter]) -> Option<Vec<Pose>> {
    let fresh: Vec<_> = parameters.iter().map(|p| LegParameter::Fresh(*p)).collect();
    Some(model.interior_program(state).ok()?.arguments(model, &LeafIndex::default(), state, &fresh, None))
}

/// Whether two values are of one constraint, and the same.
#[must_use]
pub(crate) fn same_value(a: &Parameter, b: &Parameter) -> bool {
    let turn = log_so3(a.value.rotation.conjugate() * b.value.rotation).length();
    a.constraint == b.constraint
        && a.carrier == b.carrier
        && a.value.translation.distance(b.value.translation) <= SAME_LEAF
        && turn <= SAME_LEAF
}

/// Whether a configuration is a waypoint of some transitions, travelled in either direction. A path does not say of which leg its
/// motions are, and the first leg may be a motion that was planned by itself.
fn is_waypoint(model: &Model, q: &[f64], transitions: [TransitionId; 2]) -> bool {
    let is_last = |&(id, leg): &(TransitionId, usize)| leg + 1 == model.graph.transition(id).legs.len();
    legs_ending_at(model, q, transitions).iter().any(|leg| !is_last(leg))
}

/// Residual at which the constraints at the end of a leg hold, metres and radians.
const HOLDS: f64 = 1e-5;

/// The legs of some transitions, travelled in either direction, at whose end a configuration is: each with its transition.
#[must_use]
pub(crate) fn legs_ending_at(model: &Model, q: &[f64], transitions: [TransitionId; 2]) -> Vec<(TransitionId, usize)> {
    let X_WJ = model.kinematics.poses(q);
    let both_directions = |id: TransitionId| [Some(id), model.graph.transition(id).reverse];
    let mut found = Vec::new();
    for id in transitions.into_iter().flat_map(both_directions).flatten() {
        for (number, leg) in model.graph.transition(id).legs.iter().enumerate() {
            let holds = |&target: &ConstraintId| residual(model, target, q, &X_WJ) <= HOLDS;
            let ends_here = !leg.target.is_empty() && leg.target.iter().all(holds);
            if ends_here && !found.contains(&(id, number)) {
                found.push((id, number));
            }
        }
    }
    found
}

/// Motions that follow one another on one leaf become one, except at waypoints.
#[must_use]
pub fn merged(model: &Model, motions: Vec<LeafMotion>) -> Vec<LeafMotion> {
    // Margins depend on the transition: where there are any, motions of two transitions stay apart.
    let has_margins = !model.problem.margins.is_empty();
    let size = model.problem.robot.space.size();
    let mut all: Vec<LeafMotion> = Vec::with_capacity(motions.len());
    for motion in motions {
        let is_loop = model.graph.transition(motion.transition).kind == TransitionKind::Loop;
        match all.last_mut() {
            Some(last) if !has_margins && !motion.starts_at_waypoint && last.is_on_leaf_of(&motion) => {
                last.transition = if is_loop { last.transition } else { motion.transition };
                last.residual = last.residual.max(motion.residual);
                last.knots.extend_from_slice(&motion.knots[size..]);
            }
            _ => all.push(motion),
        }
    }
    all
}

/// Whether fingers move, and nothing else.
#[must_use]
pub fn moves_fingers(motion: &LeafMotion) -> bool {
    matches!(motion.fingers, Fingers::Moving(_) | Fingers::Free)
}

/// How many grasps and releases there are between two motions: at each of them the robot stands still.
#[must_use]
pub fn grasp_changes(model: &Model, before: &LeafMotion, after: &LeafMotion) -> usize {
    let (had, has) = (&model.graph.state(before.state).grasps, &model.graph.state(after.state).grasps);
    had.iter().filter(|grasp| !has.contains(grasp)).count() + has.iter().filter(|grasp| !had.contains(grasp)).count()
}
