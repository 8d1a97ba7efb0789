//! Objects that have to be moved: what became of the tries to grasp them, where they start and where goals have them.

use foliate_components::graph::{Transition, TransitionId};
use foliate_components::infeasibility::ObjectPlace;
use foliate_components::outcome::{SearchOutcome, SideTries, TransitionStatistics};
use foliate_components::robot::ShapeIndex;
use foliate_systems::events::StopSignal;
use foliate_systems::goals::impossible::common_grasp::{NoCommonGrasp, no_common_grasp};
use foliate_systems::goals::impossible::hindrance::Hindrance;
use foliate_systems::goals::impossible::survey::why_not_held;
use foliate_systems::goals::objects_to_move;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::Search;
use foliate_systems::settings::SearchSettings;
use std::collections::BTreeMap;

/// After so many steps it is asked why objects were not grasped, first of those that no try held, then also whether a grasp takes those
/// from start to goal that were held. Few, since an answer has to come soon and costs little where a grasp is possible.
const ASKED_AFTER: [u64; 2] = [8, 24];
/// At first only of objects whose grasps were tried so often on a side: of many objects most have had few tries.
const ENOUGH: u64 = 16;

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
    pub start_hindrance: Option<Hindrance>,
    /// The same where the goal has it.
    pub goal_hindrance: Option<Hindrance>,
    /// That no grasp seems to take it from where it starts to where the goal has it: evidence, no proof.
    pub no_common_grasp: Option<NoCommonGrasp>,
}

impl ObjectTries {
    /// Whether it is likely that the object cannot be moved as the goal wants it.
    #[must_use]
    pub fn is_likely_impossible(&self) -> bool {
        self.start_hindrance.is_some() || self.goal_hindrance.is_some() || self.no_common_grasp.is_some()
    }

    /// Why it is likely that the object cannot be moved, a sentence each.
    #[must_use]
    pub fn reasons(&self) -> Vec<String> {
        let places = [(ObjectPlace::Start, &self.start_hindrance), (ObjectPlace::Goal, &self.goal_hindrance)];
        let hindered = places.into_iter().filter_map(|(place, hindrance)| Some((place, hindrance.as_ref()?)));
        let mut all: Vec<String> =
            hindered.map(|(place, hindrance)| hindrance.sentence(&self.object, place.words())).collect();
        let apart = |why: &NoCommonGrasp| format!("likely no grasp takes `{}` from start to goal: {why}", self.object);
        all.extend(self.no_common_grasp.as_ref().map(apart));
        all
    }
}

/// What is called with objects that likely cannot be moved as goals want it.
pub(crate) type ToldOfObjects = dyn Fn(&[ObjectTries]) + Send + Sync;

/// What was asked about objects so far, one row each.
#[derive(Debug, Default)]
pub(crate) struct Doubts {
    rows: Vec<ObjectTries>,
    asked: Vec<[bool; 2]>,
}

impl Doubts {
    /// Runs a search to its end, asks on the way why objects were not grasped, and tells what was found.
    pub(crate) fn run(search: &mut Search, told: Option<&ToldOfObjects>) -> (SearchOutcome, Self) {
        let mut doubts = Self::default();
        for (number, step) in ASKED_AFTER.into_iter().enumerate() {
            if let Some(outcome) = search.run_to(step) {
                return (outcome, doubts);
            }
            let found = doubts.ask(search, number + 1 == ASKED_AFTER.len());
            if let Some(told) = told.filter(|_| !found.is_empty()) {
                told(&found);
            }
        }
        (search.run(), doubts)
    }

    /// Looks for what keeps hands from objects that were not grasped on a side so far, each once, and the last time whether a grasp takes
    /// the others where they are to be. The rows of which something new was found.
    fn ask(&mut self, search: &mut Search, is_last: bool) -> Vec<ObjectTries> {
        let (model, statistics) = (search.model().clone(), search.statistics());
        let with = (search.world().resource::<SearchSettings>(), search.world().resource::<StopSignal>());
        let start = &model.problem.start;
        let mut rows = object_tries(&model, &statistics);
        self.rows.resize_with(rows.len(), ObjectTries::default);
        self.asked.resize(rows.len(), [false; 2]);
        let mut found = Vec::new();
        let asked = self.rows.iter_mut().zip(&mut self.asked);
        for ((row, object), (known, [asked_start, asked_goal])) in
            rows.iter_mut().zip(objects_to_move(&model, start)).zip(asked)
        {
            let why = |place| why_not_held(&model, with, start, object, place);
            let is_due = |side: &SideTries| side.reached == 0 && (is_last || side.tries >= ENOUGH);
            if is_due(&row.start) && !std::mem::replace(asked_start, true) {
                row.start_hindrance = why(ObjectPlace::Start);
            }
            if is_due(&row.goal) && !std::mem::replace(asked_goal, true) {
                row.goal_hindrance = why(ObjectPlace::Goal);
            }
            let is_held = known.start_hindrance.is_none() && known.goal_hindrance.is_none();
            if is_last && is_held && !row.is_likely_impossible() {
                row.no_common_grasp = no_common_grasp(&model, with, start, object);
            }
            if row.is_likely_impossible() {
                found.push(row.clone());
                known.start_hindrance = known.start_hindrance.take().or(row.start_hindrance.take());
                known.goal_hindrance = known.goal_hindrance.take().or(row.goal_hindrance.take());
                known.no_common_grasp = row.no_common_grasp.take();
            }
        }
        found
    }

    /// Takes what was found during the search into the rows at its end, where it still holds.
    pub(crate) fn take_over(self, rows: &mut [ObjectTries]) {
        for (row, found) in rows.iter_mut().zip(self.rows) {
            row.start_hindrance = found.start_hindrance.filter(|_| row.start.reached == 0);
            row.goal_hindrance = found.goal_hindrance.filter(|_| row.goal.reached == 0);
            row.no_common_grasp = found.no_common_grasp;
        }
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
