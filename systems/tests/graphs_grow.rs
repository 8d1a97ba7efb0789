//! Graphs that nobody can list start at once, grow where a search goes, and answer as the whole graph would.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::outcome::SearchOutcome;
use foliate_components::sample_problems::eight_arms_and_ten_boxes;
use foliate_systems::schedulers::mrrt::Mrrt;
use foliate_systems::settings::SearchSettings;

#[test]
fn one_box_among_ten_is_moved_by_one_arm_of_eight() {
    let began = std::time::Instant::now();
    let model = model(eight_arms_and_ten_boxes().unwrap());
    eprintln!("model {:?}", began.elapsed());
    assert!(model.graph.lazy && model.graph.states.is_empty());
    let settings = SearchSettings { max_steps: 400, ..seeded(1) };
    let began = std::time::Instant::now();
    let (outcome, one) = search(&model, &Mrrt, settings.clone(), 1);
    eprintln!("one {:?} {:?} nodes {} states {} transitions {} bytes {}", began.elapsed(), one.counter(), one.roadmap().nodes().len(), one.model().graph.states.len(), one.model().graph.transitions.len(), one.model().graph.bytes());
    assert_eq!(outcome, SearchOutcome::Solved);
    let (outcome, three) = search(&model, &Mrrt, settings, 3);
    assert_eq!(outcome, SearchOutcome::Solved);
    assert_eq!(one.roadmap().fingerprint(), three.roadmap().fingerprint());
    assert_eq!(one.path(), three.path());
}
