//! What P0 §III-A asks for is there while the search runs: rates, what blocks, how much was reached where, as components
//! for systems in the world and as events for hosts outside of it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded, stop_within};
use foliate_components::graph::TransitionId;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::outcome::{Prior, SearchOutcome};
use foliate_components::samples::{boxes_on_a_table, swap_two_boxes};
use foliate_schedulers::mrrt::Mrrt;
use foliate_systems::events::{EventSink, Feedback, SearchEvent};
use foliate_systems::search::Search;
use foliate_systems::settings::SearchSettings;

#[test]
fn every_candidate_is_counted_once_on_its_transition_and_its_state() {
    let model = model(swap_two_boxes().unwrap());
    let (_, mut search) = search(&model, &Mrrt, seeded(2), 1);
    let statistics = search.statistics();
    let attempts: u64 = statistics.iter().map(|(_, s)| s.attempts).sum();
    assert_eq!(attempts, search.counter().candidates);
    for (id, s) in &statistics {
        let rejected: u64 = s.rejections.values().sum();
        // Nothing stopped what reached the target, and something everything else.
        assert_eq!(s.reached + rejected, s.attempts, "{}", model.graph.transition(*id).name);
        let by_shapes: u64 = s.blocked_by.values().sum();
        let by_parts: u64 = s.blocking_parts(&model.problem.robot).iter().map(|pair| pair.count).sum();
        assert_eq!(by_shapes, by_parts);
        let rate = s.success_rate(Prior::default());
        assert!(rate > 0.0 && rate < 1.0 && rate <= s.projection_rate(Prior::default()) + 1e-12, "{rate}");
    }
    let states = search.states();
    let sum =
        |of: fn(&foliate_components::outcome::StateStatistics) -> u64| states.iter().map(|(_, s)| of(s)).sum::<u64>();
    assert_eq!(sum(|s| s.nodes), search.roadmap().nodes().len() as u64);
    assert_eq!(sum(|s| s.extended), search.counter().candidates);
    assert_eq!(sum(|s| s.leaves), search.world().resource::<LeafIndex>().leaves().len() as u64);
    assert!(sum(|s| s.connections_made) >= 1 && sum(|s| s.connections_tried) >= sum(|s| s.connections_made));
}

fn reports(settings: SearchSettings) -> (Search, Vec<SearchEvent>) {
    let model = model(swap_two_boxes().unwrap());
    let (sink, events) = EventSink::bounded(1 << 20);
    let mut search = Search::new(&model, &Mrrt, settings, stop_within(120), sink);
    assert_eq!(search.run(), SearchOutcome::Solved);
    (search, events.try_iter().map(|told| told.event).collect())
}

fn feedback(events: &[SearchEvent]) -> Vec<&Feedback> {
    events.iter().filter_map(|e| if let SearchEvent::Feedback(f) = e { Some(&**f) } else { None }).collect()
}

#[test]
fn the_host_hears_every_few_steps_and_at_the_end() {
    let (mut search, events) = reports(seeded(1).with(|s| s.feedback_interval = 5));
    let heard = feedback(&events);
    let last = search.counter().step;
    let mut expected: Vec<u64> = (1..=last).filter(|step| step % 5 == 0).collect();
    expected.extend((last % 5 != 0).then_some(last));
    assert_eq!(heard.iter().map(|f| f.step).collect::<Vec<_>>(), expected);
    assert!(matches!(events.last(), Some(SearchEvent::Solved { .. })), "the end comes last");
    // The last report is what the components say.
    let end = heard.last().unwrap();
    let statistics = search.statistics();
    for row in &end.transitions {
        let (_, s) = &statistics[row.transition.at()];
        assert_eq!((row.attempts, row.reached, row.partial), (s.attempts, s.reached, s.partial));
        assert_eq!(
            row.most_blocking,
            s.blocking_parts(
                &search.world().resource::<foliate_systems::planning_model::PlanningModel>().problem.robot
            )
            .first()
            .copied()
        );
    }
    assert_eq!(end.transitions.len(), statistics.iter().filter(|(_, s)| s.attempts > 0).count());
    assert!(end.transitions.windows(2).all(|w| w[0].attempts >= w[1].attempts));
}

#[test]
fn without_an_interval_there_is_one_report() {
    let (_, events) = reports(seeded(1).with(|s| s.feedback_interval = 0));
    assert_eq!(feedback(&events).len(), 1);
}

#[test]
fn the_object_in_the_way_is_named() {
    // The goal of box0 is close beside box1: a hand that sets it down there touches box1.
    let model = model(boxes_on_a_table(&[(0.6, 0.2), (0.62, -0.2)], &[(0.6, -0.13), (0.62, -0.2)]).unwrap());
    let robot = &model.problem.robot;
    let box1 = robot.part("box1").unwrap();
    let names_box1 = |transition: TransitionId| model.graph.transition(transition).name.contains("box1");
    // Now and then a search is lucky at once and meets nothing.
    let met = (1..=5).any(|seed| {
        let (_, mut search) = search(&model, &Mrrt, seeded(seed).with(|s| s.max_steps = 150), 1);
        search.statistics().into_iter().any(|(id, s)| {
            !names_box1(id) && s.blocking_parts(robot).iter().any(|pair| pair.first == box1 || pair.second == box1)
        })
    });
    assert!(met, "no transition of the other box has met box1");
}
