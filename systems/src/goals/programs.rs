//! A goal in a state, compiled: the state's manifold, the goal's requirements, and which objects stay.

use crate::goals::demands;
use crate::planning_model::model::Model;
use crate::planning_model::state_classification::coordinate;
use crate::settings::SearchSettings;
use foliate_components::Pose;
use foliate_components::constraint::{Constraint, Frame, Locked, LockedValue, Reference, RelativePose, Row};
use foliate_components::graph::{ConstraintId, ConstraintKind, StateId};
use foliate_components::pose::{exp_so3, pose_from_array};
use foliate_components::problem::{JointRest, PartialGoal};
use foliate_components::robot::{Joint, JointIndex, JointType, Source};
use foliate_kernels::constrained_motion::{AttachmentTemplate, ConstraintProgram, Outcome, Scratch, Settings, project};
use glam::DVec3;

/// A goal in a state.
#[derive(Clone, Debug)]
pub(crate) struct GoalProgram {
    /// What the kernels solve; it takes no arguments.
    pub program: ConstraintProgram,
    /// Numbers of the robots' joints that it does not depend on.
    pub idle: Vec<usize>,
}

/// Constraints with the names that errors use.
#[derive(Clone, Default)]
struct GoalConstraints {
    rigid_attachments: Vec<AttachmentTemplate>,
    constraints: Vec<(String, Constraint)>,
}

impl GoalProgram {
    /// Compiles a goal in a state. Objects and joints that rest there and that the goal leaves free stay where `start` has
    /// them, as far as nothing else requires otherwise; objects on supports only where `supported_too` says so.
    ///
    /// # Errors
    /// What contradicts what, whatever the free joints do.
    pub(crate) fn new(
        model: &Model,
        settings: &SearchSettings,
        goal: &PartialGoal,
        start: &[f64],
        state: StateId,
        supported_too: bool,
    ) -> Result<Self, String> {
        demands::fit(model, goal, state).map_err(|why| in_state(model, state, &why))?;
        let mut goal_constraints = GoalConstraints::of_goal(model, goal, state);
        let staying = Staying::in_state(model, goal, start, state, supported_too);
        let mut all = goal_constraints.clone();
        staying.iter().for_each(|staying| staying.demanded_of(&mut all));
        if let Ok(program) = all.compile(model, settings, start) {
            return Ok(Self::with_idle(model, program));
        }
        // Not all can stay: one after another, what can.
        let mut program =
            goal_constraints.compile(model, settings, start).map_err(|why| in_state(model, state, &why))?;
        for staying in &staying {
            let mut tighter = goal_constraints.clone();
            staying.demanded_of(&mut tighter);
            if let Ok(compiled) = tighter.compile(model, settings, start) {
                (goal_constraints, program) = (tighter, compiled);
            }
        }
        Ok(Self::with_idle(model, program))
    }

    fn with_idle(model: &Model, program: ConstraintProgram) -> Self {
        let objects: Vec<_> = model.objects().iter().filter_map(|o| o.root).collect();
        let mut idle = Vec::new();
        for (index, joint) in (0u32..).map(JointIndex).zip(&model.problem.robot.joints) {
            let Source::Coordinates { q, v } = joint.source else { continue };
            let mut velocities = v..v + joint.motion.velocity_size();
            if !objects.contains(&index) && velocities.all(|v| program.active().binary_search(&v).is_err()) {
                idle.extend(q..q + joint.motion.configuration_size());
            }
        }
        Self { program, idle }
    }
}

impl GoalConstraints {
    fn of_goal(model: &Model, goal: &PartialGoal, state: StateId) -> Self {
        let mut goal_constraints = Self::default();
        for (part, pose) in &goal.poses {
            if let Some(root) = object_root(model, *part) {
                goal_constraints.rigid_attachments.push(AttachmentTemplate::fixed(root, None, *pose));
            }
        }
        for &constraint in &model.graph.state(state).manifold {
            let name = model.graph.constraint(constraint).name.clone();
            goal_constraints.constraints.extend(rows_of(model, goal, constraint).map(|rows| (name, rows)));
        }
        for named in &goal.constraints {
            let rows = named.constraint.without_parameters();
            goal_constraints.constraints.extend(rows.map(|rows| (named.name.clone(), rows)));
        }
        goal_constraints.constraints.extend(coordinate_rows(model, &without_fingers(model, &goal.coordinates)));
        goal_constraints
    }

    /// Compiles. A relation that no free joint can change is asked here and then left out: a goal that is given in numbers
    /// need only lie on it as nearly as a start has to.
    fn compile(&self, model: &Model, settings: &SearchSettings, start: &[f64]) -> Result<ConstraintProgram, String> {
        let mut constraints = self.constraints.clone();
        let (robot, locked) = (&model.problem.robot, &model.problem.graph.locked);
        let solve = Settings { tolerance: settings.projection_tolerance, iterations: 0, ..Settings::default() };
        loop {
            let rows: Vec<_> = constraints.iter().map(|(_, rows)| rows.clone()).collect();
            let program = ConstraintProgram::compile(robot, &model.kinematics, &rows, &self.rigid_attachments, locked);
            let program = program.map_err(|e| e.to_string())?;
            let outcome = project(&program, &mut start.to_vec(), &[], &solve, &mut Scratch::default());
            let Outcome::Contradicted { constraint, residual } = outcome else { return Ok(program) };
            let Some(number) = constraint.checked_sub(self.rigid_attachments.len()).filter(|&n| n < constraints.len())
            else {
                return Err(format!("an object is in two places, {residual:.3e} apart"));
            };
            if residual > settings.classification_tolerance {
                return Err(format!("`{}` is off by {residual:.3e}", constraints[number].0));
            }
            constraints.remove(number);
        }
    }
}

/// Checks a goal's own numbers.
///
/// # Errors
/// Poses of what does not move freely, numbers that are not finite, out of range or out of bounds.
pub(crate) fn validate(model: &Model, goal: &PartialGoal) -> Result<(), String> {
    let robot = &model.problem.robot;
    for (part, pose) in &goal.poses {
        let name = robot.parts.get(part.0 as usize).map_or("?", |p| p.name.as_str());
        if object_root(model, *part).is_none() {
            return Err(format!("`{name}` is no movable object"));
        }
        if !pose.is_finite() {
            return Err(format!("the pose of `{name}` is not finite"));
        }
    }
    for &(index, value) in &goal.coordinates {
        if index >= robot.space.size() {
            return Err(format!("there is no number {index} in a configuration of {}", robot.space.size()));
        }
        let (low, high) = (robot.space.lower[index], robot.space.upper[index]);
        if !(value >= low - 1e-9 && value <= high + 1e-9 && value.is_finite()) {
            return Err(format!("{} = {value} is outside [{low}, {high}]", coordinate(robot, index)));
        }
    }
    for &(index, value, tolerance) in &goal.near {
        if index >= robot.space.size() || !value.is_finite() || !(tolerance >= 0.0 && tolerance.is_finite()) {
            return Err(format!("number {index} is to be near {value} within {tolerance}"));
        }
    }
    if let Some((part, _)) = goal.lying.iter().find(|(part, _)| object_root(model, *part).is_none()) {
        let name = robot.parts.get(part.0 as usize).map_or("?", |p| p.name.as_str());
        return Err(format!("`{name}` is no movable object that lies anywhere"));
    }
    within_bounds(model, goal)?;
    whole_quaternions(model, goal)
}

/// Refuses poses that are outside of the bounds of their object.
fn within_bounds(model: &Model, goal: &PartialGoal) -> Result<(), String> {
    let robot = &model.problem.robot;
    for (part, pose) in &goal.poses {
        let root = object_root(model, *part).map(|root| robot.joints[root.at()].source);
        let Some(Source::Coordinates { q, .. }) = root else { continue };
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let (value, low, high) = (pose.translation[axis], robot.space.lower[q + axis], robot.space.upper[q + axis]);
            if value < low - 1e-9 || value > high + 1e-9 {
                let object = &robot[*part].name;
                return Err(format!(
                    "`{object}` at {name} = {value} is outside its bounds, [{low}, {high}] (`root_bounds`)"
                ));
            }
        }
    }
    Ok(())
}

/// Puts the numbers that a goal wants near a value within what it allows: where they are in `q`, if that is near, else by `share` of
/// the range between both of its ends.
pub(crate) fn put_near(model: &Model, goal: &PartialGoal, q: &mut [f64], mut share: impl FnMut() -> Option<f64>) {
    let space = &model.problem.robot.space;
    for &(index, value, tolerance) in &goal.near {
        let (low, high) = ((value - tolerance).max(space.lower[index]), (value + tolerance).min(space.upper[index]));
        if low <= high {
            q[index] = share().map_or_else(|| q[index].clamp(low, high), |share| low + share * (high - low));
        }
    }
}

/// Refuses part of a quaternion, and one that is far from unit.
fn whole_quaternions(model: &Model, goal: &PartialGoal) -> Result<(), String> {
    for joint in model.problem.robot.joints.iter().filter(|j| j.motion == JointType::FreeFlyer) {
        let Source::Coordinates { q, .. } = joint.source else { continue };
        let numbers: Vec<f64> = (q + 3..q + 7).filter_map(|index| named(&goal.coordinates, index)).collect();
        let length = numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
        match numbers.len() {
            0 => {}
            4 if (length - 1.0).abs() < 1e-3 => {}
            4 => return Err(format!("the quaternion of {} has length {length}", joint.name)),
            count => return Err(format!("{count} of the four numbers of the quaternion of {} are named", joint.name)),
        }
    }
    Ok(())
}

fn named(coordinates: &[(usize, f64)], index: usize) -> Option<f64> {
    coordinates.iter().find(|(i, _)| *i == index).map(|&(_, value)| value)
}

/// The numbers that are of no finger: fingers move to where a goal has them when the path ends.
fn without_fingers(model: &Model, coordinates: &[(usize, f64)]) -> Vec<(usize, f64)> {
    coordinates.iter().copied().filter(|(index, _)| !is_finger(model, *index)).collect()
}

fn is_finger(model: &Model, index: usize) -> bool {
    let hands = 0..model.problem.graph.hands.len() as u32;
    hands.into_iter().any(|hand| model.finger_coordinates(hand).any(|finger| finger == index))
}

/// Puts the fingers that a goal names where it has them.
pub(crate) fn put_fingers(model: &Model, goal: &PartialGoal, q: &mut [f64]) {
    goal.coordinates.iter().filter(|(index, _)| is_finger(model, *index)).for_each(|&(index, value)| q[index] = value);
}

/// Numbers of a configuration as constraints: locked joints, and rows of roots.
fn coordinate_rows(model: &Model, coordinates: &[(usize, f64)]) -> Vec<(String, Constraint)> {
    let mut rows = Vec::new();
    for (index, joint) in (0u32..).map(JointIndex).zip(&model.problem.robot.joints) {
        let Source::Coordinates { q, .. } = joint.source else { continue };
        let values: Vec<_> =
            (q..q + joint.motion.configuration_size()).map(|index| named(coordinates, index)).collect();
        if values.iter().all(Option::is_none) {
            continue;
        }
        let constraint = match (joint.motion, values.as_slice()) {
            (JointType::Planar | JointType::FreeFlyer, values) => root_rows(index, joint, values),
            (_, &[Some(value)]) => Constraint::Locked(Locked { joint: index, value: LockedValue::Fixed(value) }),
            _ => continue,
        };
        rows.push((joint.name.clone(), constraint));
    }
    rows
}

/// Rows that hold the named numbers of a root: x y θ, or x y z and a whole quaternion.
fn root_rows(index: JointIndex, joint: &Joint, values: &[Option<f64>]) -> Constraint {
    let number = |i: usize| values.get(i).copied().flatten();
    let row = |is_held: bool| is_held.then_some(Row::Zero);
    let (reference, rows) = if joint.motion == JointType::Planar {
        let at = DVec3::new(number(0).unwrap_or(0.0), number(1).unwrap_or(0.0), 0.0);
        let turn = exp_so3(DVec3::Z * number(2).unwrap_or(0.0));
        let held = [0, 1].map(|i| row(number(i).is_some()));
        (Pose::from_parts(at, turn), [held[0], held[1], None, None, None, row(number(2).is_some())])
    } else {
        let identity = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let numbers: [f64; 7] = std::array::from_fn(|i| number(i).unwrap_or(identity[i]));
        let held = [0, 1, 2].map(|i| row(number(i).is_some()));
        let turned = row(number(6).is_some());
        let pose = pose_from_array(numbers).unwrap_or_default();
        (pose, [held[0], held[1], held[2], turned, turned, turned])
    };
    let a = Frame { joint: joint.parent, joint_from_frame: joint.parent_from_joint };
    Constraint::RelativePose(RelativePose {
        a,
        b: Frame::of_joint(index),
        rows,
        reference: Reference::Fixed(reference),
    })
}

/// What a constraint of the graph requires of a configuration, right-hand sides aside; `None` where nothing.
fn rows_of(model: &Model, goal: &PartialGoal, constraint: ConstraintId) -> Option<Constraint> {
    match model.graph.constraint(constraint).kind {
        ConstraintKind::Grasp { .. } => Some(Constraint::RelativePose(model.grasp(constraint)?.constraint())),
        ConstraintKind::Pregrasp { .. } => Some(Constraint::RelativePose(model.grasp(constraint)?.pregrasp())),
        ConstraintKind::Placement { object, on } => demands::lying_rows(model, goal, object, on),
        ConstraintKind::Preplacement { object, on } => {
            let lift = model.problem.graph.preplacement_distance;
            Some(model.objects()[object as usize].placement_on(on)?.resting.constraint(lift))
        }
        ConstraintKind::Rest { .. } => None,
        ConstraintKind::JointRest { .. }
        | ConstraintKind::Finger { .. }
        | ConstraintKind::Given { .. }
        | ConstraintKind::Approach { .. }
        | ConstraintKind::Lift { .. }
        | ConstraintKind::WhileHeld { .. } => model.constraint(constraint)?.without_parameters(),
    }
}

/// Something that stays where the start has it, if nothing requires otherwise.
enum Staying {
    /// An object at rest.
    Object(AttachmentTemplate),
    /// A joint at rest, such as a door's.
    Joint(String, Locked),
}

impl Staying {
    /// What stays in a state: objects that rest and whose poses are not named, and joints at rest. What lies on nothing in
    /// particular stays in any case, what lies on supports where `supported_too` says so.
    fn in_state(model: &Model, goal: &PartialGoal, start: &[f64], state: StateId, supported_too: bool) -> Vec<Self> {
        let X_WJ = model.kinematics.poses(start);
        let stays = |&constraint: &ConstraintId| {
            let record = model.graph.constraint(constraint);
            match record.kind {
                ConstraintKind::Placement { object, .. } if supported_too => Self::object(model, goal, object, &X_WJ),
                ConstraintKind::Rest { object } => Self::object(model, goal, object, &X_WJ),
                ConstraintKind::JointRest { joint } => {
                    let resting = model.problem.graph.resting_joints.get(joint as usize)?;
                    let joint = resting.joint;
                    if resting.rest != JointRest::Stays {
                        return None;
                    }
                    let Source::Coordinates { q, .. } = model.problem.robot.joints[joint.at()].source else {
                        return None;
                    };
                    Some(Self::Joint(record.name.clone(), Locked { joint, value: LockedValue::Fixed(start[q]) }))
                }
                _ => None,
            }
        };
        model.graph.state(state).manifold.iter().filter_map(stays).collect()
    }

    fn object(model: &Model, goal: &PartialGoal, object: u32, X_WJ: &[Pose]) -> Option<Self> {
        let (root, part) = (model.objects()[object as usize].root?, model.graph.objects[object as usize].part);
        let is_free = goal.poses.iter().all(|(named, _)| *named != part);
        is_free.then(|| Self::Object(AttachmentTemplate::fixed(root, None, X_WJ[root.at()])))
    }

    fn demanded_of(&self, goal_constraints: &mut GoalConstraints) {
        match self {
            Self::Object(rigid_attachment) => goal_constraints.rigid_attachments.push(rigid_attachment.clone()),
            Self::Joint(name, locked) => goal_constraints.constraints.push((name.clone(), Constraint::Locked(*locked))),
        }
    }
}

fn object_root(model: &Model, part: foliate_components::robot::PartIndex) -> Option<JointIndex> {
    let index = model.graph.objects.iter().position(|object| object.part == part)?;
    model.objects()[index].root
}

fn in_state(model: &Model, state: StateId, why: &str) -> String {
    format!("in state `{}` {why}", model.graph.state(state).name)
}
