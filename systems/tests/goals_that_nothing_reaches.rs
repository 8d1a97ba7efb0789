//! A goal that has an object elsewhere, where no state that can be reached lets the object move, is refused before the first step.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::Pose;
use foliate_components::infeasibility::Infeasibility;
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::{Goal, Problem};
use foliate_components::samples::{move_one_box, swap_two_boxes};
use foliate_schedulers::mrrt::Mrrt;
use glam::DVec3;

fn without_grippers(mut problem: Problem) -> Problem {
    problem.graph.grippers.clear();
    problem
}

fn refusal(problem: Problem) -> Option<Infeasibility> {
    let (outcome, search) = search(&model(problem), &Mrrt, seeded(1).with(|settings| settings.max_steps = 3), 1);
    match outcome {
        SearchOutcome::InfeasibleGoal(why) => {
            assert_eq!(search.counter().step, 0, "nothing is searched");
            Some(why)
        }
        _ => None,
    }
}

#[test]
fn nothing_moves_what_nothing_can_hold() {
    let Some(Infeasibility::ObjectNeverMoves { object, distance, has_grippers, .. }) =
        refusal(without_grippers(move_one_box().unwrap()))
    else {
        panic!("a box that no gripper can hold was looked for elsewhere");
    };
    assert_eq!((object.as_str(), has_grippers), ("box0", false));
    assert!(distance > 0.1, "{distance}");
}

#[test]
fn a_grasp_that_is_not_allowed_is_no_way_to_move_an_object() {
    let mut problem = move_one_box().unwrap();
    problem.graph.grasps = Some(Vec::new());
    let why = refusal(problem).unwrap();
    assert!(matches!(&why, Infeasibility::ObjectNeverMoves { has_grippers: true, .. }), "{why}");
    assert!(why.to_string().contains("no gripper may hold it"), "{why}");
}

#[test]
fn goals_as_poses_of_objects_are_refused_alike() {
    let mut problem = without_grippers(move_one_box().unwrap());
    let part = problem.robot.part("box0").unwrap();
    let pose = Pose::from_translation(DVec3::new(0.7, -0.3, 0.031));
    problem.goals = vec![Goal::object_poses(vec![(part, pose)])];
    assert!(matches!(refusal(problem), Some(Infeasibility::ObjectNeverMoves { .. })));
}

#[test]
fn what_can_be_moved_or_need_not_move_is_searched_for() {
    assert_eq!(refusal(move_one_box().unwrap()), None);
    assert_eq!(refusal(swap_two_boxes().unwrap()), None);
    // One of two goals leaves the box where it is.
    let mut problem = without_grippers(move_one_box().unwrap());
    let mut stays = problem.start.clone();
    stays[0] += 0.1;
    problem.goals.push(Goal::Configuration(stays));
    assert_eq!(refusal(problem), None);
}
