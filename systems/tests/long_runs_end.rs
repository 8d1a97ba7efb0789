//! A search that runs long ends when it is told to and where it would outgrow its memory.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use bevy_ecs::prelude::*;
use common::{model, search, seeded};
use foliate_components::candidate::Candidate;
use foliate_components::outcome::{Rejection, SearchOutcome};
use foliate_components::problem::{Goal, PartialGoal};
use foliate_components::roadmap::RoadmapStore;
use foliate_components::samples::{boxes_on_a_table, move_one_box};
use foliate_schedulers::{Scheduler, mrrt::Mrrt};
use foliate_systems::events::{EventSink, StopSignal};
use foliate_systems::schedule::SearchSet;
use foliate_systems::search::Search;

/// `mrrt`, cancelled by the host in the middle of a step.
struct CancelledAfter(SearchSet, SearchSet);

impl Scheduler for CancelledAfter {
    fn name(&self) -> &'static str {
        "cancelled"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = Mrrt.schedule(world);
        let cancel = |stop: Res<'_, StopSignal>| stop.token.cancel();
        schedule.add_systems(cancel.after(self.0).before(self.1));
        schedule
    }
}

#[test]
fn every_stage_with_long_work_looks_at_the_signal() {
    let stages = [
        (SearchSet::Rendezvous, SearchSet::Project),
        (SearchSet::Project, SearchSet::Steer),
        (SearchSet::Steer, SearchSet::Validate),
    ];
    let model = model(boxes_on_a_table(&[(0.6, 0.1)], &[(0.7, -0.2)]).unwrap());
    for (before, after) in stages {
        let scheduler = CancelledAfter(before, after);
        let mut search = Search::new(&model, &scheduler, seeded(1), StopSignal::default(), EventSink::default());
        assert_eq!(search.run(), SearchOutcome::Cancelled);
        assert_eq!(search.counter().step, 1);
        let mut candidates = search.world_mut().query::<&Candidate>();
        let world = search.world();
        let ends: Vec<_> = candidates.iter(world).map(|c| c.rejected).collect();
        assert!(ends.contains(&Some(Rejection::Stopped)), "after {before:?}: {ends:?}");
        assert!(ends.iter().all(Option::is_some), "after {before:?} a member worked on: {ends:?}");
        assert_eq!(search.roadmap().edges().len(), 0);
    }
}

#[test]
fn a_token_ends_the_drawing_of_goals_before_the_first_step() {
    let mut problem = move_one_box().unwrap();
    problem.goals = vec![Goal::Partial(PartialGoal { coordinates: vec![(0, 1.0)], ..PartialGoal::default() })];
    let stop = StopSignal::default();
    stop.token.cancel();
    let mut search = Search::new(&model(problem), &Mrrt, seeded(1), stop, EventSink::default());
    assert_eq!(search.goal_statistics().tries, 0);
    assert_eq!(search.run(), SearchOutcome::Cancelled);
}

#[test]
fn memory_is_bounded_in_bytes_also_where_nodes_are_few() {
    // Out of reach: only a limit ends it.
    let model = model(boxes_on_a_table(&[(0.6, 0.1)], &[(1.25, 0.0)]).unwrap());
    let settings = seeded(1).with(|s| s.max_bytes = 100_000);
    let (outcome, search) = search(&model, &Mrrt, settings, 1);
    assert_eq!(outcome, SearchOutcome::MemoryLimit);
    // What is bounded is all that grows: the roadmap, and what transitions need that were tried.
    assert!((100_000..200_000).contains(&search.bytes()), "{}", search.bytes());
    let (bytes, nodes) = (search.world().resource::<RoadmapStore>().bytes(), search.roadmap().nodes().len() as u64);
    // A node is its configuration of 14 numbers, its rows, its edge, and at least two knots.
    assert!(bytes / nodes > 3 * 14 * 8, "{bytes} bytes for {nodes} nodes");
}
