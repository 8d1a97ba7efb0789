//! The search solves the smallest problems that need what it is made of: one box to move, two boxes to swap.

use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::Problem;
use foliate_components::sample_problems::{move_one_box, swap_two_boxes};
use foliate_systems::events::{EventSink, StopSignal};
use foliate_systems::model::{Model, PlanningModel};
use foliate_systems::schedulers::mrrt::Mrrt;
use foliate_systems::search::Search;
use foliate_systems::settings::SearchSettings;
use std::sync::Arc;
use std::time::{Duration, Instant};

fn solve(problem: Problem, seed: u64) -> (SearchOutcome, Search) {
    let model = PlanningModel(Arc::new(Model::new(problem).unwrap()));
    let settings = SearchSettings { seed, ..SearchSettings::default() };
    let stop = StopSignal { deadline: Some(Instant::now() + Duration::from_secs(60)), ..StopSignal::default() };
    let mut search = Search::new(&model, &Mrrt, settings, stop, EventSink::default());
    (search.run(), search)
}

fn report(search: &mut Search) {
    let counter = search.counter();
    println!("{counter:?} nodes {} edges {}", search.roadmap().nodes().len(), search.roadmap().edges().len());
    for (id, s) in search.statistics() {
        println!("  {id:?} attempts {} reached {} partial {} {:?}", s.attempts, s.reached, s.partial, s.rejections);
    }
}

#[test]
fn one_box_is_moved() {
    for seed in 1..=3 {
        let started = Instant::now();
        let (outcome, mut search) = solve(move_one_box().unwrap(), seed);
        println!("seed {seed}: {outcome:?} in {:?}", started.elapsed());
        report(&mut search);
        assert_eq!(outcome, SearchOutcome::Solved);
    }
}

#[test]
fn two_boxes_are_swapped() {
    for seed in 1..=3 {
        let started = Instant::now();
        let (outcome, mut search) = solve(swap_two_boxes().unwrap(), seed);
        println!("seed {seed}: {outcome:?} in {:?}", started.elapsed());
        report(&mut search);
        assert_eq!(outcome, SearchOutcome::Solved);
    }
}
