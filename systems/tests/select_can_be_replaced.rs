//! Promise 5: every part can be replaced. Our Select is taken out of the shipped schedule and another is put in, with
//! public items only: queries, resources, and the fields of `Candidate`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleCleanupPolicy;
use common::{model, search, seeded};
use foliate_components::candidate::Candidate;
use foliate_components::graph::TransitionId;
use foliate_components::outcome::{Rejection, SearchOutcome};
use foliate_components::roadmap::{NodeId, RoadmapNode};
use foliate_components::samples::swap_two_boxes;
use foliate_schedulers::{Scheduler, mrrt::Mrrt};
use foliate_systems::exploration::entities::Weight;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::schedule::{SearchSet, StepCounter};

/// Every candidate takes any node of the roadmap in turn, and the transitions of its state in turn.
fn take_turns(
    model: Res<'_, PlanningModel>,
    step: Res<'_, StepCounter>,
    nodes: Query<'_, '_, &RoadmapNode>,
    weights: Query<'_, '_, (&TransitionId, &Weight)>,
    mut candidates: Query<'_, '_, &mut Candidate>,
) {
    // In the order of their ids.
    let all: Vec<_> = nodes.iter().collect();
    for mut candidate in &mut candidates {
        let turn = step.candidates as usize + candidate.index as usize;
        let node = turn * 7919 % all.len();
        let leaving: Vec<_> = model.graph.leaving(all[node].state).map(|(id, _)| id).collect();
        let wanted = |id: &TransitionId| weights.iter().any(|(t, w)| t == id && w.0 > 0.0);
        let leaving: Vec<_> = leaving.into_iter().filter(wanted).collect();
        match leaving.get(turn % leaving.len().max(1)) {
            Some(&transition) => {
                candidate.near = Some(NodeId(node as u32));
                candidate.transition = Some(transition);
            }
            None => candidate.reject(Rejection::NoTransition),
        }
    }
}

struct TurnTaking;

impl Scheduler for TurnTaking {
    fn name(&self) -> &'static str {
        "turns"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = Mrrt.schedule(world);
        schedule.remove_systems_in_set(SearchSet::Select, world, ScheduleCleanupPolicy::RemoveSystemsOnly).unwrap();
        schedule.add_systems(take_turns.in_set(SearchSet::Select));
        schedule
    }
}

#[test]
fn another_select_solves_the_swap() {
    let model = model(swap_two_boxes().unwrap());
    let (outcome, search) = search(&model, &TurnTaking, seeded(1), 2);
    assert_eq!(outcome, SearchOutcome::Solved);
    assert!(search.path().is_some());
}
