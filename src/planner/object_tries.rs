//! Objects that have to be moved and were never grasped: what stopped the tries.

use foliate_components::graph::{Transition, TransitionId};
use foliate_components::outcome::{Rejection, TransitionStatistics};
use foliate_systems::goals::objects_to_move;
use foliate_systems::planning_model::PlanningModel;

/// What became of the tries to grasp an object that every goal has elsewhere than the start.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ObjectTries {
    /// Name of the object.
    pub object: String,
    /// Tries of all grippers on all its handles, from where nothing holds it.
    pub tries: u64,
    /// Those that came to hold it.
    pub grasped: u64,
    /// Those for which no configuration of the robot was found: the handle is out of reach, or joint limits keep the hand from it.
    pub out_of_reach: u64,
    /// Those that collided.
    pub in_collision: u64,
    /// The pair of shapes that stopped most of these, and how many.
    pub blocked_by: Option<(String, String, u64)>,
}

/// One row for each object that has to be moved, in the order of the problem.
pub(crate) fn object_tries(
    model: &PlanningModel,
    statistics: &[(TransitionId, TransitionStatistics)],
) -> Vec<ObjectTries> {
    let robot = &model.problem.robot;
    let row = |object: usize| {
        let part = model.graph.objects[object].part;
        let mut row = ObjectTries { object: robot.parts[part.0 as usize].name.clone(), ..ObjectTries::default() };
        let mut sum = TransitionStatistics::default();
        let of_object = statistics.iter().filter(|(id, _)| takes(model, model.graph.transition(*id), object));
        for (_, s) in of_object {
            row.tries += s.attempts;
            row.grasped += s.reached;
            for (&reason, &count) in &s.rejections {
                match reason {
                    Rejection::ProjectionFailed(_) => row.out_of_reach += count,
                    Rejection::WaypointBlocked(_) | Rejection::MotionBlocked(_) => row.in_collision += count,
                    // These say nothing about the grasp.
                    Rejection::NoLeafToAimAt | Rejection::Stopped => row.tries = row.tries.saturating_sub(count),
                    _ => {}
                }
            }
            for (&pair, &count) in &s.blocked_by {
                *sum.blocked_by.entry(pair).or_default() += count;
            }
        }
        let worst = sum.blocked_by.iter().max_by(|a, b| a.1.cmp(b.1).then(b.0.cmp(a.0)));
        let shape = |shape: foliate_components::robot::ShapeIndex| robot.shapes[shape.at()].name.clone();
        row.blocked_by = worst.map(|(&(a, b), &count)| (shape(a), shape(b), count));
        row
    };
    objects_to_move(model, &model.problem.start).into_iter().map(row).collect()
}

/// Whether a transition takes an object that nothing holds before.
fn takes(model: &PlanningModel, transition: &Transition, object: usize) -> bool {
    let handles = &model.graph.objects[object].handles;
    let holds = |state| model.graph.state(state).grasps.iter().any(|(_, handle)| handles.contains(handle));
    !holds(transition.from) && holds(transition.to)
}
