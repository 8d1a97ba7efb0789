//! Which state a configuration lies in, on which leaf, and whether it may be a start or a goal.

use crate::planning_model::graph::attachment_order::pose_on_carrier;
use crate::planning_model::graph::lazy_graph::LazyGraph;
use crate::planning_model::graph::snapping::nearest_state;
use crate::planning_model::graph::states::state_keys::StateKey;
use crate::planning_model::graph::support_placement::relative_pose_residual;
use crate::planning_model::model::{Model, PlanningModel};
use crate::settings::SearchSettings;
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Grasp};
use foliate_components::graph::leaf::Parameter;
use foliate_components::graph::{ConstraintId, ConstraintKind, State, StateId};
use foliate_components::infeasibility::{CollidingPair, Infeasibility, NarrowedBy, NearestState};
use foliate_components::robot::{NarrowedLimits, Robot, ShapeIndex, Source};
use foliate_kernels::collision::{CollisionScratch, Contact};
use foliate_kernels::constraints;
use std::sync::Arc;

/// What is closer than this may overlap, metres.
const TOUCHING: f64 = 1e-6;

/// A configuration that may be a root: its state and the values of the state's foliating constraints.
#[derive(Clone, Debug, PartialEq)]
pub struct Feasible {
    /// The configuration, with unit quaternions.
    pub q: Vec<f64>,
    /// Its state.
    pub state: StateId,
    /// One per foliating constraint of the state.
    pub parameters: Vec<Parameter>,
    /// The configuration as it was given, where its fingers are not where the state has them.
    pub given: Option<Vec<f64>>,
}

/// Checks a start or goal; the error says what is wrong, with values.
///
/// # Errors
/// Wrong length, numbers that are not finite, coordinates out of bounds, locked joints elsewhere, no state, a collision: the
/// first that is found.
pub(crate) fn feasible(model: &PlanningModel, settings: &SearchSettings, q: &[f64]) -> Result<Feasible, Infeasibility> {
    let (root, X_WJ) = in_a_state(model, settings, q)?;
    let scratch = &mut CollisionScratch::at_level(settings.level);
    match model.first_collision(root.state, &X_WJ, settings.clearance_guard, scratch) {
        Some(contact) => Err(collision(model, root.state, &[contact], None)),
        None => model.check_finger_motion(settings, &root, scratch).map(|()| root),
    }
}

/// Checks a start or goal, after its state has come into being where the graph is lazy; the error says what is wrong, with values, and
/// names all pairs that collide.
///
/// # Errors
/// Wrong length, numbers that are not finite, coordinates out of bounds, locked joints elsewhere, no state, collisions, fingers that
/// cannot move to where the state has them: the first that is found.
pub fn reach_feasible(
    model: &mut PlanningModel,
    settings: &SearchSettings,
    q: &[f64],
) -> Result<Feasible, Infeasibility> {
    reach(model, settings, q, false)
}

/// As [`reach_feasible`], of the start: also what locked joints hold together is tested, here and nowhere else.
///
/// # Errors
/// As [`reach_feasible`].
pub fn reach_start(model: &mut PlanningModel, settings: &SearchSettings, q: &[f64]) -> Result<Feasible, Infeasibility> {
    reach(model, settings, q, true)
}

fn reach(
    model: &mut PlanningModel,
    settings: &SearchSettings,
    q: &[f64],
    is_start: bool,
) -> Result<Feasible, Infeasibility> {
    if model.graph.lazy {
        model.reach(q, settings.classification_tolerance);
    }
    let (root, X_WJ) = in_a_state(model, settings, q)?;
    let mut X_WJ = X_WJ;
    if let Some(given) = &root.given {
        // What is given comes first: fingers move only where that is free.
        model.kinematics.forward(given, &mut X_WJ);
    }
    let mut contacts = model.all_collisions(root.state, &X_WJ, settings.clearance_guard);
    if is_start {
        contacts.extend(model.rigid_collisions(root.state, &X_WJ, settings.clearance_guard));
    }
    if !contacts.is_empty() {
        return Err(collision(model, root.state, &contacts, Some(&X_WJ)));
    }
    let scratch = &mut CollisionScratch::at_level(settings.level);
    model.check_finger_motion(settings, &root, scratch).map(|()| root)
}

/// With the poses of the bodies also how deep shapes overlap, which a verdict does not know and which takes long.
fn collision(model: &Model, state: StateId, contacts: &[Contact], X_WJ: Option<&[Pose]>) -> Infeasibility {
    let robot = &model.problem.robot;
    let named = |shape: ShapeIndex| {
        let found = &robot.shapes[shape.at()];
        (shape, found.name.clone(), robot.links[found.link.at()].name.clone())
    };
    let pair = |contact: &Contact| {
        let (a, b) = model.pair_shapes(contact.pair);
        let overlap = X_WJ.filter(|_| contact.clearance <= TOUCHING).and_then(|X_WJ| model.overlap(contact.pair, X_WJ));
        let distance = overlap.map_or(contact.clearance, |depth| -depth);
        CollidingPair::new(named(a), named(b), distance, model.margin_in(state, contact.pair))
    };
    Infeasibility::Collision(contacts.iter().map(pair).collect())
}

/// All that is asked of a start or goal but that nothing collides there; also the poses of the bodies.
fn in_a_state(
    model: &PlanningModel,
    settings: &SearchSettings,
    q: &[f64],
) -> Result<(Feasible, Vec<Pose>), Infeasibility> {
    let robot = &model.problem.robot;
    if q.len() != robot.space.size() {
        return Err(Infeasibility::WrongLength { found: q.len(), expected: robot.space.size() });
    }
    if let Some(index) = q.iter().position(|x| !x.is_finite()) {
        return Err(Infeasibility::NotFinite { coordinate: coordinate(robot, index) });
    }
    if let Some(index) = robot.space.first_out_of_bounds(q, 1e-9) {
        return Err(Infeasibility::OutOfBounds {
            coordinate: coordinate(robot, index),
            value: q[index],
            bounds: (robot.space.lower[index], robot.space.upper[index]),
            narrowed: narrowed(robot, index).map(Box::new),
        });
    }
    let mut locked = q.to_vec();
    model.lock(&mut locked);
    if let Some(index) = (0..q.len()).find(|&i| (locked[i] - q[i]).abs() > settings.classification_tolerance) {
        let coordinate = coordinate(robot, index);
        return Err(Infeasibility::Locked { coordinate, value: q[index], locked_at: locked[index] });
    }
    let mut X_WJ = model.kinematics.poses(&locked);
    let tolerance = settings.classification_tolerance;
    let state =
        state_of(model, &locked, &X_WJ, tolerance).ok_or_else(|| why_no_state(model, &locked, &X_WJ, tolerance))?;
    let written = locked.clone();
    model.rest(state, &mut locked);
    let given = Some(model.with_fingers_of(&locked, &written)).filter(|given| *given != locked);
    model.kinematics.forward(&locked, &mut X_WJ);
    let parameters = parameters_of(model, state, &locked, &X_WJ);
    Ok((Feasible { q: locked, state, parameters, given }, X_WJ))
}

/// The state of a configuration `q` with bodies at `X_WJ`: the first, by falling priority, whose manifold it is on. In a lazy
/// graph only where the state has come into being ([`PlanningModel::reach`]).
#[must_use]
pub fn state_of(model: &Model, q: &[f64], X_WJ: &[Pose], tolerance: f64) -> Option<StateId> {
    if let Some(lazy_graph) = model.lazy_graph() {
        return lazy_graph.known(&key_of(model, lazy_graph, q, X_WJ, tolerance)?);
    }
    let count = model.graph.constraints.len() as u32;
    let holds =
        |c: ConstraintId| is_any_finger(model.graph.constraint(c).kind) || residual(model, c, q, X_WJ) <= tolerance;
    let holds: Vec<bool> = (0..count).map(|c| holds(ConstraintId(c))).collect();
    let mut order: Vec<_> = model.graph.states_of_nodes().map(|(state, _)| state).collect();
    order.sort_by_key(|&s| std::cmp::Reverse(model.graph.state(s).priority));
    order.into_iter().find(|&s| model.graph.state(s).manifold.iter().all(|&c| holds[c.at()]))
}

fn key_of(model: &Model, lazy_graph: &LazyGraph, q: &[f64], X_WJ: &[Pose], tolerance: f64) -> Option<StateKey> {
    lazy_graph.key_where(&model.problem, |kind| {
        is_any_finger(kind) || residual_of(model, lazy_grasp(lazy_graph, kind), kind, q, X_WJ) <= tolerance
    })
}

/// Whether a constraint is about a finger. Hands may be open as far as they like where a path begins and ends.
fn is_any_finger(kind: ConstraintKind) -> bool {
    matches!(kind, ConstraintKind::Finger { .. })
}

fn lazy_grasp(lazy_graph: &LazyGraph, kind: ConstraintKind) -> Option<&Grasp> {
    match kind {
        ConstraintKind::Grasp { gripper, handle } | ConstraintKind::Pregrasp { gripper, handle } => {
            lazy_graph.grasp(gripper, handle)
        }
        _ => None,
    }
}

/// The state of a configuration, locked joints at their values; `None` where it is malformed too.
pub(crate) fn state_at(model: &Model, q: &[f64], tolerance: f64) -> Option<StateId> {
    let (q, X_WJ) = posed(model, q)?;
    state_of(model, &q, &X_WJ, tolerance)
}

/// Likewise what its state would be in a lazy graph, whether that has come into being or not.
pub(crate) fn key_at(model: &Model, q: &[f64], tolerance: f64) -> Option<StateKey> {
    let (q, X_WJ) = posed(model, q)?;
    key_of(model, model.lazy_graph()?, &q, &X_WJ, tolerance)
}

/// Whether a configuration lies in a state that may come into being and has not.
pub(crate) fn is_unreached(model: &Model, q: &[f64], tolerance: f64) -> bool {
    let Some(lazy_graph) = model.lazy_graph() else { return false };
    key_at(model, q, tolerance).is_some_and(|key| lazy_graph.known(&key).is_none())
}

fn posed(model: &Model, q: &[f64]) -> Option<(Vec<f64>, Vec<Pose>)> {
    if q.len() != model.problem.robot.space.size() || q.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let mut q = q.to_vec();
    model.lock(&mut q);
    let X_WJ = model.kinematics.poses(&q);
    Some((q, X_WJ))
}

/// The largest row of a constraint's error, metres and radians.
#[must_use]
pub fn residual(model: &Model, constraint: ConstraintId, q: &[f64], X_WJ: &[Pose]) -> f64 {
    residual_of(model, model.grasp(constraint), model.graph.constraint(constraint).kind, q, X_WJ)
}

fn residual_of(model: &Model, grasp: Option<&Grasp>, kind: ConstraintKind, q: &[f64], X_WJ: &[Pose]) -> f64 {
    match kind {
        ConstraintKind::Grasp { .. } | ConstraintKind::Pregrasp { .. } => {
            let Some(grasp) = grasp else { return f64::INFINITY };
            let pregrasp = matches!(kind, ConstraintKind::Pregrasp { .. });
            let relative = if pregrasp { grasp.pregrasp() } else { grasp.constraint() };
            relative_pose_residual(&relative, X_WJ)
        }
        ConstraintKind::Placement { object, on } | ConstraintKind::Preplacement { object, on } => {
            let Some(place) = model.objects()[object as usize].placement_on(on) else { return f64::INFINITY };
            let lifted = matches!(kind, ConstraintKind::Preplacement { .. });
            place.resting.residual(if lifted { model.problem.graph.preplacement_distance } else { 0.0 }, X_WJ)
        }
        // It stays wherever it is: no rows.
        ConstraintKind::Rest { .. } => 0.0,
        ConstraintKind::JointRest { .. }
        | ConstraintKind::Finger { .. }
        | ConstraintKind::Given { .. }
        | ConstraintKind::Approach { .. }
        | ConstraintKind::Lift { .. }
        | ConstraintKind::WhileHeld { .. } => {
            let given = model.constraint_of(kind);
            given.map_or(f64::INFINITY, |given| constraints::residual(&model.problem.robot, &given, q, X_WJ))
        }
    }
}

/// The values that the foliating constraints of a state have at `q`, where the bodies are at `X_WJ`.
#[must_use]
pub(crate) fn parameters_of(model: &Model, state: StateId, q: &[f64], X_WJ: &[Pose]) -> Vec<Parameter> {
    model.graph.state(state).foliation.iter().map(|&c| parameter_of(model, c, q, X_WJ)).collect()
}

/// The value that a foliating constraint has at `q`, where the bodies are at `X_WJ`.
#[must_use]
pub fn parameter_of(model: &Model, constraint: ConstraintId, q: &[f64], X_WJ: &[Pose]) -> Parameter {
    let is_carried_by = |carrier| {
        let root = model.object_of(constraint).and_then(|object| model.objects()[object].root);
        let value = root.map_or_else(Pose::identity, |root| pose_on_carrier(root, carrier, X_WJ));
        Parameter { constraint, carrier, value }
    };
    match model.graph.constraint(constraint).kind {
        ConstraintKind::Grasp { .. } | ConstraintKind::Pregrasp { .. } => match model.grasp(constraint) {
            Some(grasp) if !model.holds_rigidly(constraint) => {
                let carrier = grasp.gripper.joint;
                let held = Constraint::RelativePose(grasp.hold(0));
                Parameter { constraint, carrier, value: constraints::parameter(&model.problem.robot, &held, q, X_WJ) }
            }
            grasp => is_carried_by(grasp.and_then(|grasp| grasp.gripper.joint)),
        },
        ConstraintKind::Placement { on, .. } | ConstraintKind::Preplacement { on, .. } => is_carried_by(on),
        ConstraintKind::Rest { .. } => is_carried_by(None),
        ConstraintKind::JointRest { .. }
        | ConstraintKind::Finger { .. }
        | ConstraintKind::Given { .. }
        | ConstraintKind::Approach { .. }
        | ConstraintKind::Lift { .. }
        | ConstraintKind::WhileHeld { .. } => {
            let given = model.constraint(constraint);
            let value = given
                .map_or_else(Pose::identity, |given| constraints::parameter(&model.problem.robot, &given, q, X_WJ));
            Parameter { constraint, carrier: None, value }
        }
    }
}

/// The state that a configuration is nearest to, and what keeps it out of that.
fn why_no_state(model: &Model, q: &[f64], X_WJ: &[Pose], tolerance: f64) -> Infeasibility {
    let lazy = model.lazy_graph().is_some();
    // A graph that was made by hand may lack the state.
    let exists = |nearest: &NearestState| lazy || model.graph.states.iter().any(|state| state.name == nearest.state);
    let nearest = nearest_state(&model.problem, &model.kinematics, q).filter(exists);
    let nearest = nearest.or_else(|| least_demanding(model, q, X_WJ, tolerance));
    Infeasibility::NoState { nearest: nearest.map(Box::new), lazy }
}

/// The constraint that keeps a configuration out of the least demanding state: of several such, out of the one that it is
/// nearest to.
fn least_demanding(model: &Model, q: &[f64], X_WJ: &[Pose], tolerance: f64) -> Option<NearestState> {
    let near = |kind: ConstraintKind, (state, constraint, error): (String, String, f64)| {
        let mut nearest = NearestState::new(state, constraint, error);
        if let ConstraintKind::Placement { object, on } = kind {
            let place = model.objects()[object as usize].placement_on(on);
            nearest.off = place.and_then(|place| place.resting.off(X_WJ)).map(Box::new);
        }
        nearest
    };
    if let Some(lazy_graph) = model.lazy_graph() {
        let residual = |kind| match is_any_finger(kind) {
            true => 0.0,
            false => residual_of(model, lazy_grasp(lazy_graph, kind), kind, q, X_WJ),
        };
        let worst = lazy_graph.worst_when_free(&model.problem, residual).filter(|&(.., r)| r > tolerance);
        return worst.map(|(kind, constraint, state, r)| near(kind, (state, constraint, r)));
    }
    let least = model.graph.states.iter().map(|s| s.priority).min();
    let worst = |state: &'_ State| {
        let counts = |&&c: &&ConstraintId| !is_any_finger(model.graph.constraint(c).kind);
        let all = state.manifold.iter().filter(counts).map(|&c| (c, residual(model, c, q, X_WJ)));
        all.filter(|&(_, r)| r > tolerance).max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let weakest = model.graph.states.iter().filter(|s| Some(s.priority) == least);
    let broken = weakest.filter_map(|state| worst(state).map(|(c, r)| (state, c, r)));
    broken.min_by(|a, b| a.2.total_cmp(&b.2)).map(|(state, constraint, r)| {
        let row = model.graph.constraint(constraint);
        near(row.kind, (state.name.clone(), row.name.clone(), r))
    })
}

/// Where a joint's range is smaller than its own limits: whose limits make it so.
fn narrowed(robot: &Robot, index: usize) -> Option<NarrowedBy> {
    let own =
        |n: &&NarrowedLimits| matches!(robot.joints[n.leader.at()].source, Source::Coordinates { q, .. } if q == index);
    let narrowed = robot.narrowed.iter().find(own)?;
    let names = narrowed.followers.iter().map(|f| robot.joints[f.at()].name.clone()).collect();
    Some(NarrowedBy::new(names, narrowed.own))
}

/// The name of a configuration number, for messages.
pub(crate) fn coordinate(robot: &Robot, index: usize) -> String {
    let owner = robot.joints.iter().find_map(|joint| match joint.source {
        Source::Coordinates { q, .. } if (q..q + joint.motion.configuration_size()).contains(&index) => {
            Some((joint, index - q))
        }
        _ => None,
    });
    match owner {
        Some((joint, 0)) if joint.motion.configuration_size() == 1 => joint.name.clone(),
        Some((joint, number)) => format!("number {number} of {}", joint.name),
        None => format!("number {index}"),
    }
}

impl PlanningModel {
    /// Makes the state of a configuration come into being, where the graph is lazy and the configuration has the right
    /// length and finite numbers; `None` where it lies in no state.
    pub fn reach(&mut self, q: &[f64], tolerance: f64) -> Option<StateId> {
        if !self.graph.lazy {
            return state_at(self, q, tolerance);
        }
        let key = key_at(self, q, tolerance)?;
        let known = self.lazy_graph.as_ref().and_then(|lazy_graph| lazy_graph.known(&key));
        known.or_else(|| Arc::make_mut(&mut self.0).reach(key))
    }
}
