//! Objects that have to be moved: what became of the tries to grasp them, where they start and where goals have them.

use foliate_components::graph::{Transition, TransitionId};
use foliate_components::outcome::{SideTries, TransitionStatistics};
use foliate_components::robot::ShapeIndex;
use foliate_systems::goals::objects_to_move;
use foliate_systems::planning_model::PlanningModel;
use std::collections::BTreeMap;

/// What became of the tries to grasp an object that every goal has elsewhere than the start.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ObjectTries {
    /// Name of the object.
    pub object: String,
    /// Tries of all grippers on all its handles by trees of the start's side, from where nothing holds it.
    pub start: SideTries,
    /// The same by trees of the goals' side: what they take is put there later.
    pub goal: SideTries,
    /// The pair of shapes that stopped most tries of both sides, and how many.
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
        let mut pairs = BTreeMap::<_, u64>::new();
        let mut sides = [SideTries::default(); 2];
        let of_object = statistics.iter().filter(|(id, _)| takes(model, model.graph.transition(*id), object));
        for (_, s) in of_object {
            sides.iter_mut().zip(&s.sides).for_each(|(sum, side)| *sum += *side);
            s.blocked_by.iter().for_each(|(&pair, &count)| *pairs.entry(pair).or_default() += count);
        }
        let worst = pairs.iter().max_by(|a, b| a.1.cmp(b.1).then(b.0.cmp(a.0)));
        let shape = |shape: ShapeIndex| robot.shapes[shape.at()].name.clone();
        let blocked_by = worst.map(|(&(a, b), &count)| (shape(a), shape(b), count));
        let [start, goal] = sides;
        ObjectTries { object: robot.parts[part.0 as usize].name.clone(), start, goal, blocked_by }
    };
    objects_to_move(model, &model.problem.start).into_iter().map(row).collect()
}

/// Whether a transition takes an object that nothing holds before.
fn takes(model: &PlanningModel, transition: &Transition, object: usize) -> bool {
    let handles = &model.graph.objects[object].handles;
    let holds = |state| model.graph.state(state).grasps.iter().any(|(_, handle)| handles.contains(handle));
    !holds(transition.from) && holds(transition.to)
}
