//! A search that ends without a path says which objects have to be moved and were never grasped, and what stopped the tries.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use foliate::components::problem::Problem;
use foliate::components::samples::boxes_on_a_table;
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolution, ObjectTries, Planner};

/// What became of the tries of a search that has forty steps.
fn tries(problem: Problem) -> Vec<ObjectTries> {
    let planner =
        Planner::new(problem).unwrap().settings(SearchSettings::default().with(|settings| settings.max_steps = 40));
    let report = match planner.first_path().solve_on(1) {
        Ok(solution) => solution.report,
        Err(NoSolution { report, .. }) => *report,
    };
    report.objects
}

#[test]
fn a_box_beyond_the_arm_is_out_of_reach() {
    // The arm reaches a little more than a metre.
    let rows = tries(boxes_on_a_table(&[(1.4, 0.0), (0.6, 0.3)], &[(0.6, -0.2), (0.5, -0.3)]).unwrap());
    let [far, near] = &rows[..] else { panic!("{rows:?}") };
    assert_eq!((far.object.as_str(), far.start.reached), ("box0", 0));
    assert!(far.start.tries > 20 && far.start.out_of_reach * 10 > far.start.tries * 9, "{far:?}");
    // Its goal is within reach.
    assert!(far.goal.reached > 0, "{far:?}");
    assert!(near.start.reached > 0, "{near:?}");
}

#[test]
fn what_need_not_move_has_no_row() {
    let rows = tries(boxes_on_a_table(&[(0.6, 0.3), (0.6, -0.3)], &[(0.6, 0.0), (0.6, -0.3)]).unwrap());
    assert_eq!(rows.iter().map(|row| row.object.as_str()).collect::<Vec<_>>(), ["box0"]);
}
