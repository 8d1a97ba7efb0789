//! Objects that have to be moved: what became of the tries to grasp them, where they start and where goals have them.

use foliate_components::graph::{Transition, TransitionId};
use foliate_components::outcome::{SideTries, TransitionStatistics};
use foliate_components::robot::ShapeIndex;
use foliate_systems::events::StopSignal;
use foliate_systems::goals::reach::{OutOfReach, why_out_of_reach};
use foliate_systems::goals::{at_goal, objects_to_move};
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::Search;
use foliate_systems::settings::SearchSettings;
use std::collections::BTreeMap;

/// After so many steps it is asked why objects are out of reach, of those whose grasps were tried so often.
pub(crate) const ASKED_AFTER: u64 = 64;
const ENOUGH: u64 = 32;

/// What became of the tries to grasp an object that every goal has elsewhere than the start.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// What seems to keep the hands from it where it starts, where no try of the start's side held it: evidence, no proof.
    pub start_reach: Option<OutOfReach>,
    /// The same where the goal has it.
    pub goal_reach: Option<OutOfReach>,
}

impl ObjectTries {
    /// Whether it is known what seems to keep hands from it.
    #[must_use]
    pub fn is_out_of_reach(&self) -> bool {
        self.start_reach.is_some() || self.goal_reach.is_some()
    }
}

/// Looks for what keeps hands from objects that were not grasped on a side so far.
pub(crate) fn explain(search: &mut Search) -> Vec<ObjectTries> {
    let (model, statistics) = (search.model().clone(), search.statistics());
    let with = (search.world().resource::<SearchSettings>(), search.world().resource::<StopSignal>());
    let start = &model.problem.start;
    let is_never_held = |side: &SideTries| side.tries >= ENOUGH && side.reached == 0 && side.out_of_reach > 0;
    let mut rows = object_tries(&model, &statistics);
    for (row, object) in rows.iter_mut().zip(objects_to_move(&model, start)) {
        if is_never_held(&row.start) {
            row.start_reach = why_out_of_reach(&model, with, start, object);
        }
        if is_never_held(&row.goal) {
            row.goal_reach = at_goal(&model, start, object).and_then(|q| why_out_of_reach(&model, with, &q, object));
        }
    }
    rows
}

/// Takes what was found during the search into the rows at its end, where it still holds.
pub(crate) fn take_over(rows: &mut [ObjectTries], found: Vec<ObjectTries>) {
    for (row, found) in rows.iter_mut().zip(found) {
        row.start_reach = found.start_reach.filter(|_| row.start.reached == 0);
        row.goal_reach = found.goal_reach.filter(|_| row.goal.reached == 0);
    }
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
        ObjectTries {
            object: robot.parts[part.0 as usize].name.clone(),
            start,
            goal,
            blocked_by,
            ..ObjectTries::default()
        }
    };
    objects_to_move(model, &model.problem.start).into_iter().map(row).collect()
}

/// Whether a transition takes an object that nothing holds before.
fn takes(model: &PlanningModel, transition: &Transition, object: usize) -> bool {
    let handles = &model.graph.objects[object].handles;
    let holds = |state| model.graph.state(state).grasps.iter().any(|(_, handle)| handles.contains(handle));
    !holds(transition.from) && holds(transition.to)
}
