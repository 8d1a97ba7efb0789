//! A search that ends without a path says which objects have to be moved and were never grasped, and what stopped the tries.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

use foliate::components::problem::Problem;
use foliate::components::samples::boxes_on_a_table;
use foliate::systems::goals::impossible::hindrance::{Hindrance, OutOfReach, Shortfall};
use foliate::systems::settings::SearchSettings;
use foliate::{NoSolution, ObjectTries, Planner};

/// What became of the tries of a search that has a hundred steps.
fn tries(problem: Problem) -> Vec<ObjectTries> {
    let planner =
        Planner::new(problem).unwrap().settings(SearchSettings::default().with(|settings| settings.max_steps = 100));
    let report = match planner.first_path().solve_on(1) {
        Ok(solution) => solution.report,
        Err(NoSolution { report, .. }) => *report,
    };
    report.objects
}

/// What is missing where it starts.
fn out_of_reach(row: &ObjectTries) -> &OutOfReach {
    match &row.start_hindrance {
        Some(Hindrance::OutOfReach(reach)) => reach,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_box_beyond_the_arm_is_out_of_reach() {
    // The arm reaches a little more than a metre; its links are 1.3 m long in all.
    let rows = tries(boxes_on_a_table(&[(1.25, 0.0), (0.6, 0.3)], &[(0.6, -0.2), (0.5, -0.3)]).unwrap());
    let [far, near] = &rows[..] else { panic!("{rows:?}") };
    assert_eq!((far.object.as_str(), far.start.reached), ("box0", 0));
    assert!(far.start.tries > 20 && far.start.out_of_reach * 10 > far.start.tries * 9, "{far:?}");
    let reach = out_of_reach(far);
    assert_eq!((reach.gripper.as_str(), reach.handle.as_str()), ("arm/hand", "box0/top"));
    assert!(matches!(reach.shortfall, Shortfall::Distance(metres) if metres > 0.05), "{reach}");
    // Its goal is within reach.
    assert!(far.goal.reached > 0, "{far:?}");
    assert!(near.start.reached > 0, "{near:?}");
}

#[test]
fn a_limit_that_is_in_the_way_is_named() {
    let problem = boxes_on_a_table(&[(0.6, 0.3)], &[(0.6, -0.2)]).unwrap();
    let solution = Planner::new(problem.clone()).unwrap().first_path().solve_on(1).unwrap();
    let robot = &problem.robot;
    // The first axis turns the arm towards the box: it may turn nearly so far.
    let path = solution.path.segments.iter().flat_map(|segment| &segment.knots);
    let turned = path.map(|q| q[0]).fold(0.0, f64::max);
    assert!(turned > 0.2, "{turned}");
    let mut limited = problem.clone();
    let most = 0.15;
    limited.robot.joints[0].upper[0] = most;
    limited.robot.space.upper[0] = most;
    limited.robot.joints[2].upper[0] = 0.0;
    limited.robot.joints[2].lower[0] = 0.0;
    limited.robot.space.upper[2] = 0.0;
    limited.robot.space.lower[2] = 0.0;
    let [row] = &tries(limited)[..] else { panic!("one box has to be moved") };
    let reach = out_of_reach(row);
    let Shortfall::Limit { joint, needed, limit } = &reach.shortfall else { panic!("{reach}") };
    assert_eq!(joint, &robot.joints[0].name);
    assert!(*limit == most && *needed > most, "{reach}");
}

#[test]
fn what_need_not_move_has_no_row() {
    let rows = tries(boxes_on_a_table(&[(0.6, 0.3), (0.6, -0.3)], &[(0.6, 0.0), (0.6, -0.3)]).unwrap());
    assert_eq!(rows.iter().map(|row| row.object.as_str()).collect::<Vec<_>>(), ["box0"]);
}
