//! Which state a configuration lies in, on which leaf, and whether it may be a start or a goal.

use crate::model::{Model, PlanningModel, hanging};
use crate::resting::relative_pose_residual;
use crate::settings::SearchSettings;
use foliate_components::Pose;
use foliate_components::graph::{ConstraintId, ConstraintKind, StateId};
use foliate_components::leaf::Parameter;
use foliate_components::robot::Robot;
use foliate_kernels::collision::CollisionScratch;

/// A configuration that may be a root: its state and the values of the state's foliating constraints.
#[derive(Clone, Debug, PartialEq)]
pub struct Feasible {
    /// The configuration, with unit quaternions.
    pub q: Vec<f64>,
    /// Its state.
    pub state: StateId,
    /// One per foliating constraint of the state.
    pub parameters: Vec<Parameter>,
}

/// Checks a start or goal; the error says what is wrong, with values.
///
/// # Errors
/// Wrong length, numbers that are not finite, coordinates out of bounds, locked joints elsewhere, no state, a collision.
pub fn feasible(model: &PlanningModel, settings: &SearchSettings, q: &[f64]) -> Result<Feasible, String> {
    let robot = &model.problem.robot;
    if q.len() != robot.space.size() {
        return Err(format!("it has {} numbers instead of {}", q.len(), robot.space.size()));
    }
    if let Some(index) = q.iter().position(|x| !x.is_finite()) {
        return Err(format!("{} is not finite", coordinate(robot, index)));
    }
    if let Some(index) = robot.space.first_out_of_bounds(q, 1e-9) {
        let (low, high) = (robot.space.lower[index], robot.space.upper[index]);
        return Err(format!("{} = {} is outside [{low}, {high}]", coordinate(robot, index), q[index]));
    }
    let mut locked = q.to_vec();
    model.lock(&mut locked);
    if let Some(index) = (0..q.len()).find(|&i| (locked[i] - q[i]).abs() > settings.membership_tolerance) {
        return Err(format!("{} = {} is locked at {}", coordinate(robot, index), q[index], locked[index]));
    }
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    model.kinematics.forward(&locked, &mut X_WJ);
    let state = state_of(model, &X_WJ, settings.membership_tolerance)
        .ok_or_else(|| format!("it lies in no state: {}", why_no_state(model, &X_WJ, settings.membership_tolerance)))?;
    if let Some(collision) = model.first_collision(state, &X_WJ, settings.clearance_guard, &mut CollisionScratch::new())
    {
        return Err(format!("{} collide ({})", model.pair_name(collision.pair), in_words(collision.clearance)));
    }
    let parameters = parameters_of(model, state, &X_WJ);
    Ok(Feasible { q: locked, state, parameters })
}

/// The state of a configuration given by the poses of all bodies: the first, by falling priority, whose manifold it is on.
#[must_use]
pub fn state_of(model: &Model, X_WJ: &[Pose], tolerance: f64) -> Option<StateId> {
    let mut order: Vec<_> = (0..model.graph.states.len() as u32).map(StateId).collect();
    order.sort_by_key(|&s| std::cmp::Reverse(model.graph.state(s).priority));
    order.into_iter().find(|&s| model.graph.state(s).manifold.iter().all(|&c| residual(model, c, X_WJ) <= tolerance))
}

/// The largest row of a constraint's error, metres and radians.
#[must_use]
pub fn residual(model: &Model, constraint: ConstraintId, X_WJ: &[Pose]) -> f64 {
    let kind = model.graph.constraint(constraint).kind;
    match kind {
        ConstraintKind::Grasp { .. } | ConstraintKind::Pregrasp { .. } => {
            let Some(grasp) = model.grasp(constraint) else { return f64::INFINITY };
            let pregrasp = matches!(kind, ConstraintKind::Pregrasp { .. });
            let relative = if pregrasp { grasp.pregrasp() } else { grasp.constraint() };
            relative_pose_residual(&relative, X_WJ)
        }
        ConstraintKind::Placement { object } | ConstraintKind::Preplacement { object } => {
            let Some(resting) = &model.objects()[object as usize].resting else { return f64::INFINITY };
            let lifted = matches!(kind, ConstraintKind::Preplacement { .. });
            resting.residual(if lifted { model.problem.graph.preplacement_distance } else { 0.0 }, X_WJ)
        }
        // It stays wherever it is: no rows.
        ConstraintKind::Rest { .. } => 0.0,
    }
}

/// The values that the foliating constraints of a state have where the bodies are.
#[must_use]
pub fn parameters_of(model: &Model, state: StateId, X_WJ: &[Pose]) -> Vec<Parameter> {
    model.graph.state(state).foliation.iter().map(|&c| parameter_of(model, c, X_WJ)).collect()
}

/// The value that a foliating constraint has where the bodies are.
#[must_use]
pub fn parameter_of(model: &Model, constraint: ConstraintId, X_WJ: &[Pose]) -> Parameter {
    let (object, carrier) = match model.graph.constraint(constraint).kind {
        ConstraintKind::Grasp { handle, .. } | ConstraintKind::Pregrasp { handle, .. } => {
            let object = model.graph.objects.iter().position(|o| o.handles.contains(&handle)).unwrap_or_default();
            (object, model.grasp(constraint).and_then(|g| g.gripper.joint))
        }
        ConstraintKind::Placement { object }
        | ConstraintKind::Preplacement { object }
        | ConstraintKind::Rest { object } => (object as usize, None),
    };
    let root = model.objects()[object].root;
    Parameter { constraint, carrier, carrier_from_object: hanging(root, carrier, X_WJ) }
}

/// The constraint that keeps a configuration out of the least demanding state, for messages.
fn why_no_state(model: &Model, X_WJ: &[Pose], tolerance: f64) -> String {
    let weakest = model.graph.states.iter().min_by_key(|s| s.priority);
    let broken = weakest.and_then(|state| {
        let worst = state.manifold.iter().map(|&c| (c, residual(model, c, X_WJ)));
        worst.filter(|&(_, r)| r > tolerance).max_by(|a, b| a.1.total_cmp(&b.1)).map(|w| (state, w))
    });
    match broken {
        Some((state, (constraint, r))) => {
            format!("`{}` of state `{}` is off by {r:.3e}", model.graph.constraint(constraint).name, state.name)
        }
        None => "no state is allowed".into(),
    }
}

fn in_words(clearance: f64) -> String {
    if clearance > 0.0 {
        format!("{:.2} mm apart", clearance * 1e3)
    } else {
        format!("{:.2} mm deep", -clearance * 1e3)
    }
}

/// The name of a configuration number, for messages.
pub(crate) fn coordinate(robot: &Robot, index: usize) -> String {
    use foliate_components::robot::Source;
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
