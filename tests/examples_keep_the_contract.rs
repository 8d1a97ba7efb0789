//! The schedulers of `examples/` keep the contract of every scheduler: they solve the small problems with paths that the check
//! proves, their answers do not depend on threads, and they end at limits and signals.

#![allow(dead_code, reason = "examples have a main function")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

#[path = "../examples/adaptive_scheduler.rs"]
mod adaptive_scheduler;
#[path = "../examples/lazy_prm.rs"]
mod lazy_prm;
#[path = "../examples/own_scheduler.rs"]
mod own_scheduler;
#[path = "../examples/select_by_queries.rs"]
mod select_by_queries;

use foliate::components::problem::{JointRest, Problem};
use foliate::components::samples::{
    boxes_on_a_table, move_one_box, open_a_drawer, swap_two_boxes, swap_with_crossed_foliations,
};
use foliate::schedulers::Scheduler;
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolutionReason, Planner, Report};
use std::sync::Arc;
use std::time::Duration;

fn schedulers() -> [Arc<dyn Scheduler>; 4] {
    [
        Arc::new(adaptive_scheduler::Adaptive),
        Arc::new(lazy_prm::LazyPrm),
        Arc::new(own_scheduler::Cautious),
        Arc::new(select_by_queries::LeastExplored),
    ]
}

fn planner(problem: Problem, scheduler: &Arc<dyn Scheduler>) -> Planner {
    Planner::new(problem).unwrap().first_path().scheduler(Arc::clone(scheduler)).time_limit(Duration::from_secs(120))
}

#[test]
fn small_problems_are_solved() {
    let problems = [
        move_one_box().unwrap(),
        swap_two_boxes().unwrap(),
        boxes_on_a_table(&[(0.6, 0.1), (0.7, 0.25)], &[(0.75, -0.1), (0.6, 0.0)]).unwrap(),
        swap_with_crossed_foliations().unwrap(),
        open_a_drawer(JointRest::Stays, 0.2).unwrap(),
    ];
    for scheduler in schedulers() {
        for (number, problem) in problems.iter().enumerate() {
            for seed in 1..=3 {
                let planner = planner(problem.clone(), &scheduler).seed(seed);
                let answer = planner.solve();
                let name = scheduler.name();
                assert!(answer.is_ok(), "{name}, problem {number}, seed {seed}: {:?}", answer.err());
                let path = answer.unwrap().path;
                assert_eq!(path.segments[0].knots[0], problem.start, "{name}, problem {number}, seed {seed}");
                assert!(path.certificate.min_clearance.is_some_and(|clearance| clearance > 0.0));
            }
        }
    }
}

#[test]
fn answers_do_not_depend_on_threads() {
    for scheduler in schedulers() {
        let planner = planner(swap_two_boxes().unwrap(), &scheduler).seed(4);
        let fingerprint = |threads| Report::of(&planner.solve_on(threads)).fingerprint;
        let one = fingerprint(1);
        assert!([2, 3, 1].iter().all(|&threads| fingerprint(threads) == one), "{}", scheduler.name());
    }
}

#[test]
fn limits_and_signals_end_the_search() {
    // Out of reach, which the lengths of the links do not prove: only a limit ends it.
    let problem = boxes_on_a_table(&[(0.6, 0.1)], &[(1.25, 0.0)]).unwrap();
    for scheduler in schedulers() {
        let settings = SearchSettings::default().with(|settings| settings.max_steps = 3);
        let answer = planner(problem.clone(), &scheduler).settings(settings).solve();
        assert!(matches!(answer.unwrap_err().reason, NoSolutionReason::StepLimit), "{}", scheduler.name());
        let cancelled = planner(problem.clone(), &scheduler);
        cancelled.cancel_token().cancel();
        assert!(matches!(cancelled.solve().unwrap_err().reason, NoSolutionReason::Cancelled), "{}", scheduler.name());
    }
}
