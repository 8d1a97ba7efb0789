//! A goal names what the task needs and nothing else: an object's pose, a hand's place, some joints, an object upright.
//! Any state in which it can be met counts; a goal that no state can meet ends with the reason.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]
#![allow(non_snake_case, reason = "pose names carry their frames")]

mod common;

use common::{Unconnected, model, search, seeded};
use foliate_components::Pose;
use foliate_components::constraint::Rests;
use foliate_components::constraint::{Constraint, Frame, Reference, RelativePose, Row};
use foliate_components::outcome::SearchOutcome;
use foliate_components::pose::pose_from_array;
use foliate_components::problem::{Goal, GraphOptions, NamedConstraint, ObjectOptions, PartialGoal, Problem};
use foliate_components::robot::{PartIndex, Robot};
use foliate_components::samples::models::{block, environment, fixed_robot, movable_object, seven_axis_arm, table};
use foliate_components::samples::{boxes_on_a_table, move_one_box, swap_with_crossed_foliations};
use foliate_kernels::collision::adjacent_links;
use foliate_schedulers::mrrt::Mrrt;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::Search;
use foliate_systems::settings::SearchSettings;
use glam::{DQuat, DVec3};

const ZERO: Option<Row> = Some(Row::Zero);

/// Two arms that face each other over a table with one box; no goal yet.
fn two_arms() -> Problem {
    let (arm, board, cube) = (seven_axis_arm(), table(DVec3::new(1.2, 1.6, 0.05)), block(DVec3::splat(0.06)));
    let turned = Pose::from_parts(DVec3::new(1.3, 0.0, 0.3), DQuat::from_rotation_z(std::f64::consts::PI));
    let robot = Robot::compose(&[
        (&arm, fixed_robot("left", Pose::from_translation(DVec3::Z * 0.3))),
        (&arm, fixed_robot("right", turned)),
        (&board, environment("table", Pose::from_translation(DVec3::new(0.65, 0.0, -0.2)))),
        (&cube, movable_object("box")),
    ])
    .unwrap();
    let graph = GraphOptions {
        grippers: ["left/hand", "right/hand"].iter().filter_map(|name| robot.gripper(name)).collect(),
        objects: vec![ObjectOptions {
            part: robot.part("box").unwrap(),
            handles: vec![robot.handle("box/top").unwrap()],
            surfaces: vec![robot.surface("box/bottom").unwrap()],
            plane: None,
        }],
        supports: vec![robot.surface("table/top").unwrap()],
        placement_margin: 1e-3,
        preplacement_distance: 0.05,
        rests: Rests::Centre,
        ..GraphOptions::default()
    };
    // Each turned aside.
    let bent = [1.2, -0.6, 0.0, 1.4, 0.0, 0.8, 0.0];
    let mut start = [bent, bent].concat();
    start.extend([0.65, 0.0, -0.2 + 0.031, 0.0, 0.0, 0.0, 1.0]);
    let ignored_pairs =
        (0..robot.parts.len() as u32).flat_map(|part| adjacent_links(&robot, PartIndex(part))).collect();
    Problem { graph, ignored_pairs, ..Problem::new("two arms", robot, start, Vec::new()) }
}

fn end_of(search: &Search) -> Vec<f64> {
    search.path().unwrap().segments.last().unwrap().knots.last().unwrap().clone()
}

fn poses_at(model: &PlanningModel, q: &[f64]) -> Vec<Pose> {
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    model.kinematics.forward(q, &mut X_WJ);
    X_WJ
}

fn goal_states(model: &PlanningModel, search: &Search) -> Vec<String> {
    let roadmap = search.roadmap();
    let goals = &search.world().resource::<Roots>().goals;
    let mut names: Vec<_> =
        goals.iter().map(|&goal| model.graph.state(roadmap.node(goal).state).name.clone()).collect();
    names.sort();
    names.dedup();
    names
}

fn in_the_air(part: PartIndex, x: f64) -> Goal {
    Goal::object_poses(vec![(part, pose_from_array([x, 0.0, 0.35, 0.0, 0.0, 0.0, 1.0]).unwrap())])
}

#[test]
fn an_object_in_the_air_is_held_there_by_either_hand() {
    let mut problem = two_arms();
    let part = problem.robot.part("box").unwrap();
    problem.goals = vec![in_the_air(part, 0.65)];
    let model = model(problem);
    let (outcome, search) = search(&model, &Mrrt, seeded(1), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    let states = goal_states(&model, &search);
    assert!(states.iter().any(|s| s.contains("left")), "{states:?}");
    assert!(states.iter().any(|s| s.contains("right")), "{states:?}");
    assert!(!states.contains(&"free".to_owned()), "no gripper holds it: {states:?}");
    let end = end_of(&search);
    let off = DVec3::new(end[14], end[15], end[16]).distance(DVec3::new(0.65, 0.0, 0.35));
    assert!(off < 1e-5, "off by {off}");
}

/// A hand at a place, whatever its direction.
fn hand_at(problem: &Problem, place: DVec3) -> NamedConstraint {
    let gripper = problem.robot.gripper("arm/hand").unwrap();
    let gripper = &problem.robot.grippers[gripper.0 as usize];
    let hand = Frame::on_link(&problem.robot, gripper.link, &gripper.link_from_gripper);
    let rows = [ZERO, ZERO, ZERO, None, None, None];
    let place =
        RelativePose { a: Frame::world(Pose::from_translation(place)), b: hand, rows, reference: Reference::Identity };
    NamedConstraint { name: "hand at the post".into(), constraint: Constraint::RelativePose(place) }
}

#[test]
fn a_hand_may_be_all_that_a_goal_asks_for() {
    let mut problem = move_one_box().unwrap();
    let place = DVec3::new(0.5, 0.3, 0.5);
    let demand = hand_at(&problem, place);
    let Constraint::RelativePose(relative) = &demand.constraint else { panic!() };
    let hand = relative.b;
    problem.goals = vec![Goal::Partial(PartialGoal { constraints: vec![demand], ..PartialGoal::default() })];
    let model = model(problem);
    for seed in 1..=3 {
        let (outcome, search) = search(&model, &Mrrt, seeded(seed), 1);
        assert_eq!(outcome, SearchOutcome::Solved);
        let X_WJ = poses_at(&model, &end_of(&search));
        let at = (X_WJ[hand.joint.unwrap().at()] * hand.joint_from_frame).translation;
        assert!(at.distance(place) < 1e-5, "the hand is at {at}");
    }
}

#[test]
fn an_object_may_be_asked_to_lie_turned_wherever_it_likes() {
    let mut problem = boxes_on_a_table(&[(0.6, 0.15), (0.6, -0.15)], &[(0.6, 0.15), (0.6, -0.15)]).unwrap();
    let part = problem.robot.part("box0").unwrap();
    let root = problem.robot.parts[part.0 as usize].root_joint.unwrap();
    // A quarter turn about the vertical, from how it stands.
    let a = Frame::world(Pose::from_parts(DVec3::ZERO, DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2)));
    let rows = [None, None, None, ZERO, ZERO, ZERO];
    let turned = RelativePose { a, b: Frame::of_joint(root), rows, reference: Reference::Identity };
    let turned = NamedConstraint { name: "turned".into(), constraint: Constraint::RelativePose(turned) };
    problem.goals = vec![Goal::Partial(PartialGoal { constraints: vec![turned], ..PartialGoal::default() })];
    let model = model(problem);
    let (outcome, search) = search(&model, &Mrrt, seeded(1), 2);
    assert_eq!(outcome, SearchOutcome::Solved);
    let end = end_of(&search);
    let turn = poses_at(&model, &end)[root.at()].rotation * DVec3::X;
    assert!(turn.distance(DVec3::Y) < 1e-5, "its x axis points along {turn}");
    // The goal does not name the other box.
    let size = end.len();
    assert!((end[size - 7] - 0.6).abs() < 1e-6 && (end[size - 6] + 0.15).abs() < 1e-6, "box1 was moved: {end:?}");
}

/// The grasp leaves a turn free and the goal leaves the place free: neither determines the box, both together are solved.
#[test]
fn an_object_may_be_asked_to_be_high_up_in_whatever_grasp() {
    let mut problem = swap_with_crossed_foliations().unwrap();
    let part = problem.robot.part("box1").unwrap();
    let root = problem.robot.parts[part.0 as usize].root_joint.unwrap();
    let rows = [None, None, ZERO, None, None, None];
    let a = Frame::world(Pose::from_translation(DVec3::Z * 0.4));
    let high = RelativePose { a, b: Frame::of_joint(root), rows, reference: Reference::Identity };
    let high = NamedConstraint { name: "high up".into(), constraint: Constraint::RelativePose(high) };
    problem.goals = vec![Goal::Partial(PartialGoal { constraints: vec![high], ..PartialGoal::default() })];
    let model = model(problem);
    let (outcome, search) = search(&model, &Mrrt, seeded(1), 2);
    assert_eq!(outcome, SearchOutcome::Solved);
    let states = goal_states(&model, &search);
    assert!(states.iter().all(|s| s.contains("box1")), "a gripper holds it: {states:?}");
    let height = poses_at(&model, &end_of(&search))[root.at()].translation.z;
    assert!((height - 0.4).abs() < 1e-5, "it is at {height}");
}

/// Where the goal wants one object another stands: it has to go, though the goal does not say where.
#[test]
fn an_object_in_the_way_of_a_goal_is_moved() {
    let mut problem = boxes_on_a_table(&[(0.6, 0.15), (0.6, -0.15)], &[(0.6, 0.15), (0.6, -0.15)]).unwrap();
    let part = problem.robot.part("box0").unwrap();
    let there = pose_from_array([0.6, -0.15, 0.031, 0.0, 0.0, 0.0, 1.0]).unwrap();
    problem.goals = vec![Goal::object_poses(vec![(part, there)])];
    let (outcome, search) = search(&model(problem), &Mrrt, seeded(1), 2);
    assert_eq!(outcome, SearchOutcome::Solved);
    assert!(!search.goal_statistics().blocked_by.is_empty(), "where the start has them they collide");
}

#[test]
fn some_joints_may_be_all_that_a_goal_asks_for() {
    let mut problem = move_one_box().unwrap();
    problem.goals =
        vec![Goal::Partial(PartialGoal { coordinates: vec![(0, 1.1), (3, 0.9)], ..PartialGoal::default() })];
    let (outcome, search) = search(&model(problem), &Mrrt, seeded(1), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    let end = end_of(&search);
    assert_eq!((end[0], end[3]), (1.1, 0.9));
}

#[test]
fn a_goal_that_holds_already_is_solved() {
    let mut problem = move_one_box().unwrap();
    let first = problem.start[0];
    problem.goals = vec![Goal::Partial(PartialGoal { coordinates: vec![(0, first)], ..PartialGoal::default() })];
    let (outcome, search) = search(&model(problem), &Mrrt, seeded(1), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    assert!(search.path().is_some());
}

fn refused(problem: Problem, settings: SearchSettings) -> (String, Search) {
    let (outcome, search) = search(&model(problem), &Mrrt, settings, 2);
    let SearchOutcome::InfeasibleGoal(why) = outcome else { panic!("{outcome:?}") };
    let why = why.to_string();
    (why, search)
}

#[test]
fn a_goal_that_contradicts_every_state_is_told_with_the_constraint_and_never_tried() {
    let mut problem = move_one_box().unwrap();
    let part = problem.robot.part("box0").unwrap();
    let root = problem.robot.parts[part.0 as usize].root_joint.unwrap();
    let rows = [None, None, ZERO, None, None, None];
    let low = RelativePose {
        a: Frame::world(Pose::identity()),
        b: Frame::of_joint(root),
        rows,
        reference: Reference::Identity,
    };
    let low = NamedConstraint { name: "sunk in the table".into(), constraint: Constraint::RelativePose(low) };
    let Goal::Partial(mut goal) = in_the_air(part, 0.6) else { panic!() };
    goal.constraints.push(low);
    problem.goals = vec![Goal::Partial(goal)];
    let (why, search) = refused(problem, seeded(1));
    assert!(why.contains("contradicts every state") && why.contains("sunk in the table"), "{why}");
    assert_eq!(search.goal_statistics().tries, 0);
    assert_eq!(search.counter().step, 0);
}

#[test]
fn a_goal_out_of_reach_is_given_up_after_the_stated_tries_with_the_reason() {
    let mut problem = move_one_box().unwrap();
    let demand = hand_at(&problem, DVec3::new(0.0, 0.0, 4.0));
    problem.goals = vec![Goal::Partial(PartialGoal { constraints: vec![demand], ..PartialGoal::default() })];
    let settings = seeded(1).with(|s| s.goal_tries = 800);
    let (why, search) = refused(problem, settings);
    assert!(why.contains("in 800 tries") && why.contains("projection failed 800 times"), "{why}");
    assert_eq!(search.goal_statistics().projection_failed, 800);
    assert!(search.counter().step > 0, "the first tries need not be the last");
}

#[test]
fn a_goal_in_the_way_of_others_is_told_with_the_pair() {
    // Both boxes in one place.
    let mut problem = boxes_on_a_table(&[(0.6, 0.15), (0.6, -0.15)], &[(0.6, 0.15), (0.6, -0.15)]).unwrap();
    let pose = pose_from_array([0.7, 0.0, 0.031, 0.0, 0.0, 0.0, 1.0]).unwrap();
    let parts = ["box0", "box1"].map(|name| (problem.robot.part(name).unwrap(), pose));
    problem.goals = vec![Goal::object_poses(parts.to_vec())];
    let (why, search) = refused(problem, seeded(1).with(|s| s.goal_tries = 64));
    assert!(why.contains("in collision") && why.contains("box0") && why.contains("box1"), "{why}");
    assert!(!search.goal_statistics().blocked_by.is_empty());
}

#[test]
fn numbers_that_make_no_goal_are_refused() {
    let partial = |coordinates: Vec<(usize, f64)>| {
        let mut problem = move_one_box().unwrap();
        problem.goals = vec![Goal::Partial(PartialGoal { coordinates, ..PartialGoal::default() })];
        refused(problem, seeded(1)).0
    };
    assert!(partial(vec![(99, 0.0)]).contains("no number 99"));
    assert!(partial(vec![(0, 99.0)]).contains("outside ["));
    assert!(partial(vec![(0, f64::NAN)]).contains("outside ["));
    assert!(partial(vec![(10, 0.0)]).contains("of the four numbers"));
    let mut problem = move_one_box().unwrap();
    let table = problem.robot.part("table").unwrap();
    problem.goals = vec![in_the_air(table, 0.5)];
    assert!(refused(problem, seeded(1)).0.contains("`table` is no movable object"));
}

#[test]
fn more_goals_are_drawn_while_the_search_runs_on_any_number_of_threads_alike() {
    let run = |threads| {
        let mut problem = two_arms();
        let part = problem.robot.part("box").unwrap();
        // Elsewhere on the table, and no two trees are joined: goals exist, but no path to any.
        let elsewhere = pose_from_array([0.5, 0.3, -0.169, 0.0, 0.0, 0.0, 1.0]).unwrap();
        problem.goals = vec![Goal::object_poses(vec![(part, elsewhere)])];
        let settings = seeded(5).with(|s| (s.goal_samples, s.goal_interval, s.max_steps) = (1, 1, 9));
        let (outcome, search) = search(&model(problem), &Unconnected, settings, threads);
        assert_eq!(outcome, SearchOutcome::StepLimit);
        let goals = search.world().resource::<Roots>().goals.len();
        (goals, search.roadmap().fingerprint(), search.goal_statistics().clone())
    };
    let alone = run(1);
    assert_eq!(alone.0, 5, "one at the start, and after 1, 2, 4 and 8 steps");
    assert_eq!(alone, run(3));
}
