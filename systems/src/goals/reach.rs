//! Why no hand takes an object where it stands: inverse kinematics within the joint limits, and a little beyond them.
//!
//! It is evidence and no proof: as many tries as are made, from random configurations.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::events::StopSignal;
use crate::goals::programs::GoalProgram;
use crate::planning_model::model::{Model, PlanningModel};
use crate::runtime::random::{Purpose, stream};
use crate::settings::SearchSettings;
use foliate_components::Pose;
use foliate_components::constraint::Frame;
use foliate_components::graph::{State, StateId};
use foliate_components::problem::{OtherHands, PartialGoal, Problem};
use foliate_components::robot::{GripperIndex, HandleIndex, JointType, Source};
use foliate_kernels::constrained_motion::{Scratch, Settings, project};
use std::sync::Arc;

/// Tries for each grasp.
const TRIES: u32 = 32;

/// Grasps that are tried at most.
const GRASPS: usize = 24;

/// So far beyond their limits joints may go, radians and metres.
const BEYOND: (f64, f64) = (0.5, 0.2);

/// What keeps every hand from an object, by the grasp that comes nearest.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfReach {
    /// The gripper.
    pub gripper: String,
    /// The handle.
    pub handle: String,
    /// What is missing.
    pub shortfall: Shortfall,
}

/// What is missing for a grasp.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shortfall {
    /// A joint would have to go beyond its limit, radians or metres.
    Limit {
        /// The joint.
        joint: String,
        /// What it would need.
        needed: f64,
        /// What it may do.
        limit: f64,
    },
    /// The gripper stays so far from the handle, metres.
    Distance(f64),
}

impl std::fmt::Display for OutOfReach {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { gripper, handle, shortfall } = self;
        match shortfall {
            Shortfall::Limit { joint, needed, limit } => {
                write!(f, "for {gripper} to hold {handle}, {joint} would need {needed:.4}, and its limit is {limit:.4}")
            }
            Shortfall::Distance(metres) => {
                write!(f, "{gripper} comes no nearer to {handle} than {:.0} mm", metres * 1e3)
            }
        }
    }
}

/// Why no hand takes an object where `q` has it; `None` where one does, where no grasp can be tried, and where the stop signal is raised.
#[must_use]
pub fn why_out_of_reach(
    model: &PlanningModel,
    (settings, stop): (&SearchSettings, &StopSignal),
    q: &[f64],
    object: usize,
) -> Option<OutOfReach> {
    let root = model.objects()[object].root?;
    let entry = &model.graph.objects[object];
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    model.kinematics.forward(q, &mut X_WJ);
    let goal = PartialGoal {
        poses: vec![(entry.part, X_WJ[root.at()])],
        other_hands: OtherHands::Anything,
        ..PartialGoal::default()
    };
    let wide = Model::with_graph(widened(&model.problem), model.graph.clone()).ok()?;
    let wide = PlanningModel(Arc::new(wide));
    let is_own = |state: &State| matches!(&state.grasps[..], [(_, handle)] if entry.handles.contains(handle));
    let held = model.graph.states_of_nodes().filter(|(_, state)| is_own(state)).take(GRASPS);
    let mut nearest: Option<(f64, OutOfReach)> = None;
    let mut beyond: Option<(f64, OutOfReach)> = None;
    for (id, state) in held {
        let attempt = Attempt { settings, stop, goal: &goal, q, state: id, grasp: state.grasps[0] };
        match attempt.within(model) {
            Within::Reached => return None,
            Within::Missed(distance) => {
                keep(&mut nearest, distance, || attempt.told(model, Shortfall::Distance(distance)))
            }
            Within::Untried => {}
        }
        if let Some((excess, shortfall)) = attempt.beyond(model, &wide) {
            keep(&mut beyond, excess, || attempt.told(model, shortfall));
        }
    }
    beyond.or(nearest).filter(|_| !stop.is_raised()).map(|(_, told)| told)
}

/// Keeps what is less.
fn keep(best: &mut Option<(f64, OutOfReach)>, value: f64, told: impl FnOnce() -> OutOfReach) {
    if best.as_ref().is_none_or(|(least, _)| value < *least) {
        *best = Some((value, told()));
    }
}

/// The problem with joints that may go beyond their limits.
fn widened(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    let robot = &mut problem.robot;
    for joint in robot.joints.iter_mut().filter(|joint| !joint.is_immovable()) {
        let Source::Coordinates { q, .. } = joint.source else { continue };
        let by = match joint.motion {
            JointType::Revolute { .. } => BEYOND.0,
            JointType::Prismatic { .. } => BEYOND.1,
            JointType::Planar | JointType::FreeFlyer => continue,
        };
        joint.lower[0] -= by;
        joint.upper[0] += by;
        robot.space.lower[q] -= by;
        robot.space.upper[q] += by;
    }
    problem
}

/// Tries of one grasp.
struct Attempt<'a> {
    settings: &'a SearchSettings,
    stop: &'a StopSignal,
    goal: &'a PartialGoal,
    q: &'a [f64],
    state: StateId,
    grasp: (GripperIndex, HandleIndex),
}

/// What came of tries within the limits.
enum Within {
    Reached,
    /// The least distance of gripper and handle where a try ended, metres.
    Missed(f64),
    Untried,
}

impl Attempt<'_> {
    fn within(&self, model: &PlanningModel) -> Within {
        let mut best = Within::Untried;
        self.each(model, |q, is_converged| {
            best = match (&best, is_converged) {
                (Within::Reached, _) | (_, true) => Within::Reached,
                (Within::Missed(least), false) => Within::Missed(least.min(self.distance(model, q))),
                (Within::Untried, false) => Within::Missed(self.distance(model, q)),
            };
            matches!(best, Within::Reached)
        });
        best
    }

    /// The try that needs least beyond a limit, and which.
    fn beyond(&self, model: &PlanningModel, wide: &PlanningModel) -> Option<(f64, Shortfall)> {
        let robot = &model.problem.robot;
        let mut best: Option<(f64, Shortfall)> = None;
        self.each(wide, |q, is_converged| {
            let excess = |index: usize| (robot.space.lower[index] - q[index]).max(q[index] - robot.space.upper[index]);
            let worst = (0..q.len()).map(|index| (index, excess(index))).max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((index, excess)) = worst.filter(|(_, excess)| is_converged && *excess > 0.0) else { return false };
            if best.as_ref().is_none_or(|(least, _)| excess < *least) {
                let (low, high) = (robot.space.lower[index], robot.space.upper[index]);
                let limit = if q[index] < low { low } else { high };
                let joint = crate::planning_model::state_classification::coordinate(robot, index);
                best = Some((excess, Shortfall::Limit { joint, needed: q[index], limit }));
            }
            false
        });
        best
    }

    /// Solves from several configurations, until `look` has seen enough.
    fn each(&self, model: &PlanningModel, mut look: impl FnMut(&[f64], bool) -> bool) {
        let Ok(program) = GoalProgram::new(model, self.settings, self.goal, self.q, self.state, true) else { return };
        let solve = Settings {
            tolerance: self.settings.projection_tolerance,
            iterations: self.settings.projection_iterations,
            ..Settings::default()
        };
        let mut scratch = Scratch::default();
        for number in (0..TRIES).take_while(|_| !self.stop.is_raised()) {
            let mut q = self.q.to_vec();
            if number > 0 {
                let mut rng = stream(self.settings.seed, Purpose::REACH, u64::from(self.state.0), number);
                model.problem.robot.space.random(&mut rng, &mut q);
                model.lock(&mut q);
            }
            let is_converged = project(&program.program, &mut q, &[], &solve, &mut scratch).is_converged();
            if look(&q, is_converged) {
                return;
            }
        }
    }

    /// How far the gripper is from the handle, which is where the goal has it, metres.
    fn distance(&self, model: &Model, q: &[f64]) -> f64 {
        let robot = &model.problem.robot;
        let (gripper, handle) = (&robot.grippers[self.grasp.0.at()], &robot.handles[self.grasp.1.at()]);
        let place = |frame: Frame, q: &[f64]| {
            let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
            model.kinematics.forward(q, &mut X_WJ);
            frame.joint.map_or(Pose::identity(), |joint| X_WJ[joint.at()]) * frame.joint_from_frame
        };
        let hand = place(Frame::on_link(robot, gripper.link, &gripper.link_from_gripper), q);
        let handle = place(Frame::on_link(robot, handle.link, &handle.link_from_handle), self.q);
        hand.translation.distance(handle.translation)
    }

    fn told(&self, model: &Model, shortfall: Shortfall) -> OutOfReach {
        let robot = &model.problem.robot;
        OutOfReach {
            gripper: robot.grippers[self.grasp.0.at()].name.clone(),
            handle: robot.handles[self.grasp.1.at()].name.clone(),
            shortfall,
        }
    }
}
