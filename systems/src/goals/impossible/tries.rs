//! Single tries of a grasp at a site: inverse kinematics within the joint limits, and a little beyond them.

use crate::goals::programs::GoalProgram;
use crate::planning_model::model::Model;
use crate::runtime::random::{Purpose, stream};
use crate::settings::SearchSettings;
use foliate_components::graph::StateId;
use foliate_components::problem::Problem;
use foliate_components::robot::{JointType, PartKind, Source};
use foliate_kernels::constrained_motion::{Scratch, Settings, project};

/// So far beyond their limits joints may go, radians and metres.
const BEYOND: (f64, f64) = (0.5, 0.2);

/// One try: the first changes no more than it has to, the others begin anywhere. Whether it converged.
pub(super) fn solve(
    model: &Model,
    settings: &SearchSettings,
    program: &GoalProgram,
    (q, state, number): (&[f64], StateId, u32),
    scratch: &mut Scratch,
) -> (Vec<f64>, bool) {
    let mut q = q.to_vec();
    if number > 0 {
        let mut rng = stream(settings.seed, Purpose::REACH, u64::from(state.0), number);
        model.problem.robot.space.random(&mut rng, &mut q);
        model.lock(&mut q);
    }
    let is_converged = converges(settings, program, &mut q, scratch);
    (q, is_converged)
}

/// Projects a configuration onto a grasp at its site.
pub(super) fn converges(
    settings: &SearchSettings,
    program: &GoalProgram,
    q: &mut [f64],
    scratch: &mut Scratch,
) -> bool {
    let solve = Settings {
        tolerance: settings.projection_tolerance,
        iterations: settings.projection_iterations,
        ..Settings::default()
    };
    project(&program.program, q, &[], &solve, scratch).is_converged()
}

/// The problem with joints that may go beyond their limits. Only objects keep their shapes, which may say where they rest.
pub(super) fn widened(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    let robot = &mut problem.robot;
    let (parts, links) = (&robot.parts, &robot.links);
    robot.shapes.retain(|shape| parts[links[shape.link.at()].part.at()].kind == PartKind::Object);
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
