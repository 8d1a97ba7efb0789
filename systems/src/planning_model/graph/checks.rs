//! Why no constraint graph can be built of a problem, and how large one may be.
//!
//! These checks come before any state is enumerated, so they hold for lazy graphs too.

use crate::planning_model::graph::attachment_order::root_of;
use crate::planning_model::graph::support_placement::carrying_bodies;
use foliate_components::constraint::MaskError;
use foliate_components::problem::{GraphOptions, Problem};
use foliate_components::robot::RootJoint;

/// A graph with more states than this is not built whole; [`Model::new`](crate::planning_model::model::Model::new) lets it
/// grow while it is searched.
pub const MOST_STATES: usize = 1_000;

/// Maps from grippers to handles that are looked through before rules: with few of them allowed a graph is small.
pub(crate) const MOST_SETS: usize = 20_000;

/// Why no graph can be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum GraphError {
    #[error("{grippers} grippers and {handles} handles make more than {MOST_STATES} states, too many to be listed")]
    TooManyStates { grippers: usize, handles: usize },
    #[error(
        "more than {most} transitions may leave a state ({grasps} grasps, and an object may lie on {bodies} bodies); \
         name the grasps that may occur (`grasps` in the scene), and no more supports that move than are needed"
    )]
    TooManyTransitions { grasps: usize, bodies: usize, most: usize },
    #[error(
        "object `{0}` has surfaces, but no support that is not its own is named; name supports or take the surfaces away"
    )]
    NoSupport(String),
    #[error("object `{0}` does not move freely (its root joint is neither a free-flyer nor fixed)")]
    ObjectNotFree(String),
    #[error("handle `{handle}`: {source}")]
    Handle { handle: String, source: MaskError },
    #[error("{user} names constraint number {number}, and the problem has {count}")]
    NoSuchConstraint { user: String, number: u32, count: usize },
    #[error("`{0}` has parameters: what holds while an object is held must be the same on every leaf")]
    HeldParameter(String),
    #[error("transition `{transition}` names state number {number}, and the problem has {count} of its own")]
    NoSuchState { transition: String, number: u32, count: usize },
    #[error("resting joint `{0}` has not exactly one coordinate of its own")]
    RestingJoint(String),
    #[error("no state is allowed: every combination of grasps is refused by the rules")]
    NothingAllowed,
}

/// Checks what no graph could be built from, whole or not.
pub(crate) fn check(problem: &Problem) -> Result<(), GraphError> {
    check_objects(problem)?;
    check_numbers(&problem.graph)?;
    check_resting_joints(problem)
}

fn check_objects(problem: &Problem) -> Result<(), GraphError> {
    let (robot, options) = (&problem.robot, &problem.graph);
    for object in &options.objects {
        let part = &robot.parts[object.part.at()];
        if part.root == RootJoint::Planar {
            return Err(GraphError::ObjectNotFree(part.name.clone()));
        }
        let moves = root_of(robot, object.part).is_some();
        if moves && !object.surfaces.is_empty() && carrying_bodies(robot, options, object).is_empty() {
            return Err(GraphError::NoSupport(part.name.clone()));
        }
    }
    Ok(())
}

/// Numbers come from hosts too, not only from files that have been read with care.
fn check_numbers(options: &GraphOptions) -> Result<(), GraphError> {
    let constraints = |user: &str, numbers: &[u32]| {
        let count = options.constraints.len();
        match numbers.iter().find(|&&n| n as usize >= count) {
            Some(&number) => Err(GraphError::NoSuchConstraint { user: user.into(), number, count }),
            None => Ok(()),
        }
    };
    constraints("`everywhere`", &options.everywhere)?;
    for rule in &options.while_held {
        constraints("`while_held`", &rule.constraints)?;
        let foliates = |&&number: &&u32| options.constraints[number as usize].constraint.foliates();
        if let Some(&number) = rule.constraints.iter().find(foliates) {
            return Err(GraphError::HeldParameter(options.constraints[number as usize].name.clone()));
        }
    }
    for state in &options.states {
        constraints(&format!("state `{}`", state.name), &state.constraints)?;
    }
    let count = options.states.len();
    for transition in &options.transitions {
        let named = [transition.from, transition.to].into_iter().chain(transition.legs.iter().map(|leg| leg.within));
        if let Some(number) = named.into_iter().find(|&n| n as usize >= count) {
            return Err(GraphError::NoSuchState { transition: transition.name.clone(), number, count });
        }
        for leg in &transition.legs {
            constraints(&format!("transition `{}`", transition.name), &leg.until)?;
        }
    }
    Ok(())
}

fn check_resting_joints(problem: &Problem) -> Result<(), GraphError> {
    use foliate_components::robot::Source;
    for resting in &problem.graph.resting_joints {
        let joint = &problem.robot.joints[resting.joint.at()];
        if joint.motion.configuration_size() != 1 || matches!(joint.source, Source::Follows { .. }) {
            return Err(GraphError::RestingJoint(joint.name.clone()));
        }
    }
    Ok(())
}
