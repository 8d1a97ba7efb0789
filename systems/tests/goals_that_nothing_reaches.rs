//! A goal that has an object elsewhere, where no state that can be reached lets the object move, or where geometry rules out every grasp,
//! is refused before the first step.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::Pose;
use foliate_components::constraint::Rests;
use foliate_components::infeasibility::{Infeasibility, ObjectPlace, RuledOut};
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::{Goal, Holding, PartialGoal, Problem, Rule};
use foliate_components::samples::{boxes_on_a_table, make_a_step, move_one_box, swap_two_boxes};
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

/// One box from place to place (x, y on the table, metres), on a table that is large enough.
fn far_box(start: (f64, f64), goal: (f64, f64)) -> Problem {
    boxes_on_a_table(&[start], &[goal]).unwrap()
}

#[test]
fn the_lengths_of_links_rule_out_what_is_too_far() {
    // The links of the arm are 1.3 m long in all.
    let near = (0.6, 0.1);
    for (start, goal, wanted) in [((1.48, 0.6), near, ObjectPlace::Start), (near, (1.48, 0.6), ObjectPlace::Goal)] {
        let Some(Infeasibility::NoGraspPossible { object, place, grasps }) = refusal(far_box(start, goal)) else {
            panic!("a box beyond the arm was searched for");
        };
        assert_eq!((object.as_str(), place, grasps.len()), ("box0", wanted, 1));
        assert!(
            matches!(grasps[0].why, RuledOut::TooFar { distance, longest, .. } if distance > longest),
            "{grasps:?}"
        );
    }
    // Within the length of the links: whether the joints let it get there is left to the search.
    assert_eq!(refusal(far_box((1.2, 0.0), near)), None);
}

#[test]
fn another_goal_within_reach_keeps_the_search_going() {
    let mut problem = far_box((0.6, 0.1), (1.48, 0.6));
    let nearer = far_box((0.6, 0.1), (0.6, -0.2));
    problem.goals.extend(nearer.goals);
    assert_eq!(refusal(problem), None);
}

#[test]
fn a_handle_with_a_free_translation_is_not_judged_by_length() {
    let mut problem = far_box((1.48, 0.6), (0.6, 0.1));
    let handle = problem.robot.handle("box0/top").unwrap();
    problem.robot.handles[handle.at()].mask[0] = false;
    assert!(!matches!(refusal(problem), Some(Infeasibility::NoGraspPossible { .. })));
}

#[test]
fn states_that_no_transition_joins_are_told() {
    let mut problem = make_a_step().unwrap();
    let mut lifted = problem.start.clone();
    lifted[1] -= 0.3;
    problem.goals = vec![Goal::Configuration(lifted)];
    assert_eq!(refusal(problem.clone()), None);
    problem.graph.transitions.clear();
    let apart = Infeasibility::GoalStateApart { start: "standing".into(), goal: "lifted".into() };
    assert_eq!(refusal(problem.clone()), Some(apart));
    // A partial goal is not looked for in states that nothing leads to: what is left contradicts it.
    let Goal::Configuration(lifted) = &problem.goals[0] else { panic!("it is whole") };
    let coordinates = lifted.iter().copied().enumerate().collect();
    problem.goals = vec![Goal::Partial(PartialGoal { coordinates, ..PartialGoal::default() })];
    let why = refusal(problem).unwrap().to_string();
    assert!(why.contains("contradicts every state that transitions lead to"), "{why}");
}

/// A box in the hand that shall be out of it.
fn box_in_the_hand() -> Problem {
    let mut problem = move_one_box().unwrap();
    problem.graph.rests = Rests::default();
    let held = PartialGoal { held: vec![problem.robot.part("box0").unwrap()], ..PartialGoal::default() };
    problem.goals = vec![Goal::Partial(held)];
    let (outcome, search) = search(&model(problem.clone()), &Mrrt, seeded(1), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    problem.start = search.path().unwrap().segments.last().unwrap().knots.last().unwrap().clone();
    problem.goals = vec![out_of_hand(&problem, Holding::Nothing)];
    problem
}

fn out_of_hand(problem: &Problem, holding: Holding) -> Goal {
    Goal::Partial(PartialGoal { hands: vec![(problem.graph.grippers[0], holding)], ..PartialGoal::default() })
}

/// With all supports so many times as large.
fn with_supports(mut problem: Problem, factor: f64) -> Problem {
    for support in problem.graph.supports.clone() {
        let points = &mut problem.robot.surfaces[support.at()].points;
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        points.iter_mut().for_each(|point| *point = middle + (*point - middle) * factor);
    }
    problem
}

#[test]
fn what_no_support_takes_stays_in_the_hand() {
    let problem = box_in_the_hand();
    assert_eq!(refusal(problem.clone()), None);
    let Some(Infeasibility::NeverPutDown { object, gripper, too_small }) =
        refusal(with_supports(problem.clone(), 1e-3))
    else {
        panic!("a place for the box was looked for on a table of a millimetre");
    };
    assert_eq!((object.as_str(), gripper.as_str(), too_small.len()), ("box0", "arm/hand", 1));
    // Where a goal names a support it wants the box there, not in the hand.
    let mut lying = with_supports(problem.clone(), 1e-3);
    let on = vec![(lying.robot.part("box0").unwrap(), lying.graph.supports.clone())];
    lying.goals = vec![Goal::Partial(PartialGoal { lying: on, ..PartialGoal::default() })];
    assert!(matches!(refusal(lying), Some(Infeasibility::NeverPutDown { .. })));
    // By the rule of centres nothing is proved, and one goal that lets the hand keep the box is enough.
    let mut centred = with_supports(problem.clone(), 1e-3);
    centred.graph.rests = Rests::Centre;
    assert!(!matches!(refusal(centred), Some(Infeasibility::NeverPutDown { .. })));
    let mut kept = with_supports(problem, 1e-3);
    kept.goals.push(out_of_hand(&kept, Holding::Anything));
    assert_eq!(refusal(kept), None);
}

#[test]
fn what_no_rule_lets_go_stays_in_the_hand() {
    let mut problem = box_in_the_hand();
    let holds = vec![(problem.graph.grippers[0], problem.robot.handle("box0/top"))];
    problem.graph.rules = vec![Rule { grasps: holds, allowed: true }];
    let place = vec![(problem.robot.part("box0").unwrap(), Pose::from_translation(DVec3::new(0.7, -0.3, 0.031)))];
    let at_rest = vec![Goal::object_poses(place)];
    for goals in [problem.goals.clone(), at_rest] {
        let problem = Problem { goals, ..problem.clone() };
        let Some(why) = refusal(problem) else { panic!("a way to put the box down was looked for") };
        assert!(matches!(&why, Infeasibility::NeverPutDown { too_small, .. } if too_small.is_empty()), "{why}");
        assert!(why.to_string().contains("no state is allowed in which nothing holds it"), "{why}");
    }
    // Over the table the hand may keep it.
    let place = vec![(problem.robot.part("box0").unwrap(), Pose::from_translation(DVec3::new(0.7, -0.3, 0.1)))];
    problem.goals = vec![Goal::object_poses(place)];
    assert!(!matches!(refusal(problem), Some(Infeasibility::NeverPutDown { .. })));
}
