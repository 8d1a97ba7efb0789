//! Graphs that are too large to list start at once, grow where a search goes, and answer as the whole graph would.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::graph::{ConstraintGraph, ConstraintId, StateId, Transition};
use foliate_components::outcome::SearchOutcome;
use foliate_components::pose::pose_from_array;
use foliate_components::problem::{Goal, Problem, Rule};
use foliate_components::robot::{Gripper, GripperIndex};
use foliate_components::samples::{
    carry_a_box_with_its_lid, eight_arms_and_ten_boxes, hold_a_lid_by_a_magnet, make_a_step, move_one_box,
    move_one_box_with_a_level_hand, open_a_box_and_move_it, open_a_drawer_with_a_box_in_it, put_a_lid_on_a_box,
    swap_two_boxes, swap_with_crossed_foliations,
};
use foliate_schedulers::mrrt::Mrrt;
use foliate_systems::planning_model::graph::checks::GraphError;
use foliate_systems::planning_model::graph::enumeration::build_constraint_graph;
use foliate_systems::planning_model::{Model, ModelError, PlanningModel};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

const TOLERANCE: f64 = 1e-4;

fn new_lazy(problem: Problem) -> PlanningModel {
    PlanningModel(Arc::new(Model::new_lazy(problem).unwrap()))
}

/// All that can be reached from a configuration.
fn grown_from(problem: &Problem, q: &[f64]) -> ConstraintGraph {
    let mut model = new_lazy(problem.clone());
    model.reach(q, TOLERANCE).unwrap();
    let mut next = 0;
    while next < model.graph.states.len() {
        model.expand(StateId(next as u32));
        next += 1;
    }
    model.graph.clone()
}

/// What a graph says, in names.
fn in_words(graph: &ConstraintGraph) -> BTreeMap<String, Vec<String>> {
    let constraints =
        |ids: &[ConstraintId]| ids.iter().map(|&c| graph.constraint(c).name.clone()).collect::<Vec<_>>().join(", ");
    let transition = |t: &Transition| {
        let leg = |leg: &foliate_components::graph::Leg| {
            let (target, drawn) = (constraints(&leg.target), constraints(&leg.drawn));
            format!("{} in {} until {target} ({drawn}) {}", leg.name, graph.state(leg.state).name, leg.short)
        };
        let reverse = t.reverse.map(|r| graph.transition(r).name.as_str());
        let legs: Vec<_> = t.legs.iter().map(leg).collect();
        let (to, adds) = (&graph.state(t.to).name, constraints(&t.adds));
        format!("{} {:?} to {to} weight {:.6} adds {adds} back by {reverse:?}: {legs:?}", t.name, t.kind, t.weight)
    };
    let state = |(index, state): (usize, &foliate_components::graph::State)| {
        let (manifold, foliation) = (constraints(&state.manifold), constraints(&state.foliation));
        let mut words = vec![format!("{:?} {} holds {manifold} leaves {foliation}", state.written, state.priority)];
        words.extend(graph.leaving(StateId(index as u32)).map(|(_, t)| transition(t)));
        (state.name.clone(), words)
    };
    graph.states.iter().enumerate().map(state).collect()
}

/// Names of the states that transitions lead to from the one of that name.
fn reachable_from(graph: &ConstraintGraph, name: &str) -> BTreeSet<String> {
    let mut reached = vec![graph.state_named(name).unwrap()];
    let mut next = 0;
    while next < reached.len() {
        let more: Vec<_> = graph.leaving(reached[next]).map(|(_, t)| t.to).filter(|to| !reached.contains(to)).collect();
        more.into_iter().for_each(|to| {
            if !reached.contains(&to) {
                reached.push(to)
            }
        });
        next += 1;
    }
    reached.into_iter().map(|state| graph.state(state).name.clone()).collect()
}

#[test]
fn what_grows_is_what_would_have_been_built() {
    let problems = [
        swap_two_boxes(),
        swap_with_crossed_foliations(),
        put_a_lid_on_a_box(),
        hold_a_lid_by_a_magnet(),
        carry_a_box_with_its_lid(),
        open_a_box_and_move_it(),
        open_a_drawer_with_a_box_in_it(0.2),
        make_a_step(),
        move_one_box_with_a_level_hand(),
    ];
    for problem in problems {
        let problem = problem.unwrap();
        let whole = build_constraint_graph(&problem).unwrap();
        let grown = grown_from(&problem, &problem.start);
        let reachable = reachable_from(&whole, &grown.states[0].name);
        let mut whole = in_words(&whole);
        whole.retain(|state, _| reachable.contains(state));
        assert_eq!(in_words(&grown), whole, "{}", problem.name);
    }
}

#[test]
fn rules_and_tables_hold_for_what_grows() {
    let mut problem = swap_two_boxes().unwrap();
    let (hand, first) = (problem.graph.grippers[0], problem.graph.objects[0].handles[0]);
    let never = Rule { grasps: vec![(hand, Some(first))], allowed: false };
    problem.graph.rules = vec![never, Rule { grasps: Vec::new(), allowed: true }];
    assert_eq!(in_words(&grown_from(&problem, &problem.start)), in_words(&build_constraint_graph(&problem).unwrap()));
    problem.graph.rules.clear();
    problem.graph.grasps = Some(vec![(hand, first)]);
    let grown = grown_from(&problem, &problem.start);
    let names: Vec<_> = grown.states.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["free", "arm/hand grasps box0/top"]);
}

#[test]
fn searches_of_graphs_that_grow_find_paths_that_name_their_transitions() {
    for problem in [swap_two_boxes(), swap_with_crossed_foliations(), put_a_lid_on_a_box(), make_a_step()] {
        let model = new_lazy(problem.unwrap());
        let (outcome, search) = search(&model, &Mrrt, seeded(1), 1);
        assert_eq!(outcome, SearchOutcome::Solved, "{}", model.problem.name);
        let graph = &search.model().graph;
        for pair in search.path().unwrap().segments.windows(2) {
            let [before, after] = pair else { unreachable!() };
            // Travelled forwards or backwards, a transition leads on from where the last one ended.
            let (before, after) = (graph.transition(before.transition), graph.transition(after.transition));
            let same = before.name == after.name;
            assert!(same || before.to == after.from, "{}: `{}` then `{}`", model.problem.name, before.name, after.name);
        }
        // The model that others share has not changed.
        assert!(model.graph.states.is_empty());
    }
}

#[test]
fn goals_that_leave_something_free_are_looked_for_near_the_start_first() {
    let mut problem = move_one_box().unwrap();
    let part = problem.robot.part("box0").unwrap();
    let Goal::Configuration(goal) = problem.goals[0].clone() else { panic!("whole") };
    let mut numbers: [f64; 7] = goal[goal.len() - 7..].try_into().unwrap();
    problem.goals = vec![Goal::object_poses(vec![(part, pose_from_array(numbers).unwrap())])];
    let model = new_lazy(problem.clone());
    let (outcome, search_on_table) = search(&model, &Mrrt, seeded(1), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    let end = search_on_table.path().unwrap().segments.last().unwrap().state;
    assert_eq!(search_on_table.model().graph.state(end).name, "free");

    // In the air a gripper has to hold it: the start's state contradicts that, a neighbour does not.
    numbers[2] += 0.2;
    problem.goals = vec![Goal::object_poses(vec![(part, pose_from_array(numbers).unwrap())])];
    let model = new_lazy(problem);
    let (outcome, search_in_air) = search(&model, &Mrrt, seeded(1), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    let end = search_in_air.path().unwrap().segments.last().unwrap().state;
    assert_eq!(search_in_air.model().graph.state(end).name, "arm/hand grasps box0/top");
}

#[test]
fn starts_in_no_state_are_refused_with_the_reason() {
    let mut problem = swap_two_boxes().unwrap();
    let z = problem.start.len() - 5;
    problem.start[z] += 0.1;
    let (outcome, _) = search(&new_lazy(problem), &Mrrt, seeded(1), 1);
    let SearchOutcome::InfeasibleStart(why) = outcome else { panic!("{outcome:?}") };
    let why = why.to_string();
    assert!(why.contains("`place_box1` of state `free` is off by 1.0"), "{why}");
}

#[test]
fn one_box_among_ten_is_moved_by_one_arm_of_eight() {
    let model = model(eight_arms_and_ten_boxes().unwrap());
    assert!(model.graph.lazy && model.graph.states.is_empty());
    let settings = seeded(1).with(|s| s.max_steps = 400);
    let (outcome, one) = search(&model, &Mrrt, settings.clone(), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    let (_, three) = search(&model, &Mrrt, settings, 3);
    assert_eq!(one.roadmap().fingerprint(), three.roadmap().fingerprint());
    assert_eq!(one.path(), three.path());
    assert_eq!(in_words(&one.model().graph), in_words(&three.model().graph));
}

#[test]
fn a_thousand_nodes_make_a_graph_grow_by_megabytes_only() {
    let mut problem = eight_arms_and_ten_boxes().unwrap();
    // All ten boxes elsewhere: far beyond a thousand nodes.
    let Goal::Configuration(goal) = &mut problem.goals[0] else { panic!("whole") };
    let first = goal.len() - 70;
    goal[first] -= 0.2;
    (0..10).for_each(|number| goal[first + 7 * number] += 0.16);
    let model = model(problem);
    let settings = seeded(1).with(|s| (s.max_nodes, s.max_steps) = (1000, 2000));
    let (outcome, search) = search(&model, &Mrrt, settings, 2);
    assert_eq!(outcome, SearchOutcome::MemoryLimit);
    let graph = &search.model().graph;
    assert!(search.roadmap().nodes().len() >= 1000);
    let (states, transitions) = (graph.states.len(), graph.transitions.len());
    assert!(
        states < 20_000 && transitions < 40_000 && graph.bytes() < 32 << 20,
        "{states} states, {transitions} transitions"
    );
}

#[test]
fn graphs_whose_states_cannot_be_left_are_refused_with_a_sentence() {
    let mut problem = eight_arms_and_ten_boxes().unwrap();
    for number in 0..2000 {
        let hand = problem.robot.grippers[0].clone();
        problem.robot.grippers.push(Gripper { name: format!("hand{number}"), ..hand });
        problem.graph.grippers.push(GripperIndex(problem.robot.grippers.len() as u32 - 1));
    }
    let ModelError::Graph(error) = Model::new(problem).unwrap_err() else { panic!("a graph's error") };
    assert!(matches!(error, GraphError::TooManyTransitions { .. }), "{error}");
}
