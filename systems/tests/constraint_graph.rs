//! The constraint graph of P1 Algorithm 1: which states and transitions there are, how they are called, where crossed
//! transitions stand, what restricts them, and that one built by hand serves as well.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{search, seeded};
use foliate_components::constraint::Constraint;
use foliate_components::graph::{ConstraintGraph, TransitionKind};
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::{NamedConstraint, Problem, Rule, WrittenLeg, WrittenState, WrittenTransition};
use foliate_components::robot::{Gripper, GripperIndex};
use foliate_components::samples::{
    boxes_on_a_table, hold_a_lid_by_a_magnet, make_a_step, put_a_lid_on_a_box, swap_two_boxes,
};
use foliate_schedulers::mrrt::Mrrt;
use foliate_systems::planning_model::graph::checks::GraphError;
use foliate_systems::planning_model::graph::enumeration::build_constraint_graph;
use foliate_systems::planning_model::{Model, PlanningModel};
use std::sync::Arc;

/// Two boxes, and a second gripper on the same link as the first.
fn two_grippers() -> Problem {
    let mut problem = swap_two_boxes().unwrap();
    let first = problem.robot.grippers[problem.graph.grippers[0].at()].clone();
    problem.robot.grippers.push(Gripper { name: "arm/second".into(), ..first });
    problem.graph.grippers.push(GripperIndex(problem.robot.grippers.len() as u32 - 1));
    problem
}

fn names(graph: &ConstraintGraph) -> Vec<&str> {
    graph.states.iter().map(|s| s.name.as_str()).collect()
}

#[test]
fn states_are_injective_maps_from_grippers_to_handles() {
    let graph = build_constraint_graph(&swap_two_boxes().unwrap()).unwrap();
    assert_eq!(names(&graph), ["free", "arm/hand grasps box0/top", "arm/hand grasps box1/top"]);
    // 2 grippers on 2 handles: 1 + 4 + 2 states.
    let graph = build_constraint_graph(&two_grippers()).unwrap();
    assert_eq!(graph.states.len(), 7);
    assert!(graph.state_named("arm/hand grasps box1/top : arm/second grasps box0/top").is_some());
    // More grasps are asked first when the state of a configuration is.
    let free = graph.state_named("free").unwrap();
    assert!(graph.states.iter().all(|s| s.priority >= graph.state(free).priority));
}

#[test]
fn transitions_pass_the_waypoints_of_a_grasp() {
    let graph = build_constraint_graph(&swap_two_boxes().unwrap()).unwrap();
    let constraint_names = |name: &str| -> Vec<Vec<&str>> {
        let transition = graph.transition(graph.transition_named(name).unwrap());
        let targets = |ids: &[_]| ids.iter().map(|&c| graph.constraint(c).name.as_str()).collect();
        transition.legs.iter().map(|leg| targets(&leg.target)).collect()
    };
    let (pregrasp, grasp) = ("arm/hand pregrasps box0/top", "arm/hand grasps box0/top");
    assert_eq!(constraint_names("arm/hand > box0/top | f"), [[pregrasp], [grasp], ["preplace_box0"]]);
    assert_eq!(constraint_names("arm/hand < box0/top | 0-0"), [["preplace_box0"], ["place_box0"], [pregrasp]]);
}

#[test]
fn crossed_transitions_stand_only_where_the_target_adds_rows() {
    let graph = build_constraint_graph(&two_grippers()).unwrap();
    for transition in &graph.transitions {
        let (from, to) = (graph.state(transition.from), graph.state(transition.to));
        let adds = to.foliation.iter().any(|c| !from.foliation.contains(c));
        match transition.kind {
            TransitionKind::Crossed => assert!(adds, "{}", transition.name),
            TransitionKind::Regular => {
                let twin = graph.transition_named(&format!("{}_ls", transition.name));
                assert_eq!(twin.is_some(), adds, "{}", transition.name);
            }
            TransitionKind::Loop => assert_eq!(transition.from, transition.to),
        }
        let reverse = graph.transition(transition.reverse.unwrap());
        assert_eq!((reverse.from, reverse.to), (transition.to, transition.from));
    }
}

#[test]
fn tables_and_rules_restrict_the_states() {
    let mut tabled = two_grippers();
    let (hand, second) = (tabled.graph.grippers[0], tabled.graph.grippers[1]);
    let (box0, box1) = (tabled.graph.objects[0].handles[0], tabled.graph.objects[1].handles[0]);
    tabled.graph.grasps = Some(vec![(hand, box0), (second, box1)]);
    assert_eq!(build_constraint_graph(&tabled).unwrap().states.len(), 4);

    let mut ruled = two_grippers();
    // Never both hands full; everything else.
    let both = |a, b| Rule { grasps: vec![(hand, Some(a)), (second, Some(b))], allowed: false };
    let rest = Rule { grasps: Vec::new(), allowed: true };
    ruled.graph.rules = vec![both(box0, box1), both(box1, box0), rest.clone()];
    assert_eq!(build_constraint_graph(&ruled).unwrap().states.len(), 5);

    ruled.graph.rules = vec![Rule { allowed: false, ..rest }];
    assert_eq!(build_constraint_graph(&ruled).unwrap_err(), GraphError::NothingAllowed);
}

#[test]
fn graphs_that_are_too_large_are_not_listed() {
    let places: Vec<(f64, f64)> = (0..8).map(|i| (0.5 + 0.1 * f64::from(i % 4), 0.1 * f64::from(i / 4))).collect();
    let mut problem = boxes_on_a_table(&places, &places).unwrap();
    for number in 0..7 {
        let hand = problem.robot.grippers[0].clone();
        problem.robot.grippers.push(Gripper { name: format!("arm/hand{number}"), ..hand });
        problem.graph.grippers.push(GripperIndex(problem.robot.grippers.len() as u32 - 1));
    }
    let error = build_constraint_graph(&problem).unwrap_err();
    assert_eq!(error, GraphError::TooManyStates { grippers: 8, handles: 8 });
    assert!(error.to_string().contains("8 grippers and 8 handles make more than 1000 states"));
    // They grow instead (see `graphs_grow`).
    assert!(Model::new(problem).unwrap().graph.lazy);
}

#[test]
fn a_graph_by_hand_is_searched_as_well() {
    let problem = swap_two_boxes().unwrap();
    let mut graph = build_constraint_graph(&problem).unwrap();
    // Without the crossed transitions the trees meet only in states of one leaf; the swap has none on its way.
    graph.transitions.retain(|t| t.kind != TransitionKind::Crossed);
    graph.transitions.iter_mut().for_each(|t| t.reverse = None);
    let model = PlanningModel(Arc::new(Model::with_graph(problem, graph).unwrap()));
    let settings = seeded(1).with(|s| s.max_steps = 20);
    assert_eq!(search(&model, &Mrrt, settings, 1).0, SearchOutcome::StepLimit);
}

#[test]
fn objects_lie_on_bodies_that_move_but_never_on_themselves() {
    let problem = put_a_lid_on_a_box().unwrap();
    let graph = build_constraint_graph(&problem).unwrap();
    let free: Vec<_> = names(&graph).into_iter().filter(|n| n.starts_with("free")).collect();
    // Not box on lid on box.
    assert_eq!(free, ["free", "free : lid on box", "free : box on lid"]);
    let constraint = |name: &str| graph.constraints.iter().any(|c| c.name == name);
    assert!(constraint("place_lid") && constraint("place_lid_on_box") && constraint("preplace_lid_on_box"));
    assert!(graph.transition_named("arm/hand < lid/top, lid on box | 0-1").is_some());
    // Reverses pair releases with the grasps that undo them.
    let release = graph.transition(graph.transition_named("arm/hand < lid/top, lid on box | 0-1").unwrap());
    let grasp = graph.transition(release.reverse.unwrap());
    assert_eq!(grasp.name, "arm/hand > lid/top | f : lid on box");

    let mut alone = problem;
    alone.graph.supports.retain(|s| alone.robot.surfaces[s.at()].name == "lid/top");
    assert_eq!(build_constraint_graph(&alone).unwrap_err(), GraphError::NoSupport("lid".into()));
}

#[test]
fn what_is_held_only_through_another_object_lies() {
    // The magnet is on the box: the hand that holds the lid does not hold the box.
    let problem = hold_a_lid_by_a_magnet().unwrap();
    let graph = build_constraint_graph(&problem).unwrap();
    let manifold = |name: &str| -> Vec<String> {
        let state = graph.state(graph.state_named(name).unwrap());
        state.manifold.iter().map(|&c| graph.constraint(c).name.clone()).collect()
    };
    let (lid, magnet) = ("arm/hand grasps lid/top", "box/magnet grasps lid/under");
    assert_eq!(manifold(&format!("{lid} : {magnet}")), ["place_box", lid, magnet]);
    assert_eq!(manifold("arm/hand grasps box/side : box/magnet grasps lid/under").len(), 2);
    let model = Model::new(problem).unwrap();
    let state = model.graph.state_named(magnet).unwrap();
    assert_eq!(model.carriers(state).order, [0, 1]);
}

#[test]
fn objects_that_hold_each_other_do_not_carry_each_other_in_a_circle() {
    let mut problem = hold_a_lid_by_a_magnet().unwrap();
    let (robot, graph) = (&mut problem.robot, &mut problem.graph);
    let back =
        Gripper { name: "lid/magnet".into(), link: robot.link("lid/base_link").unwrap(), ..robot.grippers[1].clone() };
    robot.grippers.push(back);
    let back = GripperIndex(robot.grippers.len() as u32 - 1);
    graph.grippers.push(back);
    graph.grasps.as_mut().unwrap().push((back, robot.handle("box/side").unwrap()));
    let model = Model::new(problem).unwrap();
    let name = "box/magnet grasps lid/under : lid/magnet grasps box/side";
    let state = model.graph.state_named(name).unwrap();
    let kinds: Vec<_> =
        model.graph.state(state).manifold.iter().map(|&c| model.graph.constraint(c).name.as_str()).collect();
    // The first grasp carries; the box, which nothing else holds, lies.
    assert_eq!(kinds, ["place_box", "box/magnet grasps lid/under", "lid/magnet grasps box/side"]);
    assert_eq!(model.carriers(state).order, [0, 1]);
    assert!(model.interior_program(state).is_ok());
}

/// A robot that stands on both feet, shifts its weight, and lifts a foot: the states of a quasi-static walk.
fn walk() -> Problem {
    let mut problem = make_a_step().unwrap();
    let graph = &mut problem.graph;
    let foot = graph.constraints[0].clone();
    let balance = foot.constraint.without_parameters().unwrap();
    let named =
        |name: &str, constraint: &Constraint| NamedConstraint { name: name.into(), constraint: constraint.clone() };
    graph.constraints = vec![
        named("left foot", &foot.constraint),
        named("right foot", &foot.constraint),
        named("between the feet", &balance),
        named("over the left foot", &balance),
        named("over the right foot", &balance),
    ];
    let state = |name: &str, constraints: &[u32]| WrittenState { name: name.into(), constraints: constraints.into() };
    graph.states = vec![
        state("both", &[2, 0, 1]),
        state("both_left", &[3, 0, 1]),
        state("left", &[3, 0]),
        state("both_right", &[4, 0, 1]),
        state("right", &[4, 1]),
    ];
    let transition = |name: &str, from, to, within| WrittenTransition {
        name: name.into(),
        from,
        to,
        legs: vec![WrittenLeg { within, until: Vec::new(), short: false }],
    };
    graph.transitions = vec![
        transition("shift left", 0, 1, 0),
        transition("shift back", 1, 0, 0),
        transition("lift right", 1, 2, 2),
        transition("land right", 2, 1, 2),
    ];
    problem
}

#[test]
fn states_and_transitions_may_be_written() {
    let graph = build_constraint_graph(&walk()).unwrap();
    assert_eq!(names(&graph), ["both", "both_left", "left", "both_right", "right"]);
    let transition = |name: &str| graph.transition(graph.transition_named(name).unwrap());
    let targets = |name: &str| -> Vec<&str> {
        transition(name).legs[0].target.iter().map(|&c| graph.constraint(c).name.as_str()).collect()
    };
    // What the target requires beyond the state of the leg.
    assert_eq!(targets("shift left | both"), ["over the left foot"]);
    assert!(targets("shift back | both_left").is_empty() && targets("lift right | both_left").is_empty());
    assert_eq!(targets("land right | left"), ["right foot"]);
    // Only landing reaches leaves that it can choose.
    let crossed: Vec<_> = graph.transitions.iter().filter(|t| t.kind == TransitionKind::Crossed).collect();
    assert_eq!(crossed.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(), ["land right | left_ls"]);
    assert_eq!(crossed[0].legs[0].drawn, crossed[0].adds);
    let reverse = |name: &str| graph.transition(transition(name).reverse.unwrap()).name.as_str();
    assert_eq!(reverse("lift right | both_left"), "land right | left");
    assert_eq!(reverse("shift left | both"), "shift back | both_left");
}

#[test]
fn numbers_that_name_nothing_are_refused() {
    let mut problem = walk();
    problem.graph.states[3].constraints.push(9);
    let error = build_constraint_graph(&problem).unwrap_err();
    assert_eq!(error.to_string(), "state `both_right` names constraint number 9, and the problem has 5");
    let mut problem = walk();
    problem.graph.transitions[2].legs[0].within = 7;
    let error = build_constraint_graph(&problem).unwrap_err();
    assert_eq!(error.to_string(), "transition `lift right` names state number 7, and the problem has 5 of its own");
    let mut problem = walk();
    problem.graph.everywhere = vec![5];
    assert!(matches!(build_constraint_graph(&problem), Err(GraphError::NoSuchConstraint { .. })));
}

#[test]
fn written_states_multiply_with_grasps() {
    let mut problem = swap_two_boxes().unwrap();
    let state = |name: &str| WrittenState { name: name.into(), constraints: Vec::new() };
    problem.graph.states = vec![state("day"), state("night")];
    let transition = |name: &str, from, to| WrittenTransition { name: name.into(), from, to, legs: Vec::new() };
    problem.graph.transitions = vec![transition("dusk", 0, 1), transition("dawn", 1, 0)];
    let graph = build_constraint_graph(&problem).unwrap();
    assert_eq!(names(&graph)[..3], ["day", "night", "day : arm/hand grasps box0/top"]);
    assert_eq!(graph.states.len(), 6);
    for name in ["dusk | day", "dusk | day : 0-0", "dawn | night : 0-1", "arm/hand > box0/top | night"] {
        assert!(graph.transition_named(name).is_some(), "{name}");
    }
}

#[test]
fn heaps_are_not_listed_either() {
    // Any of eight boxes may lie on any other.
    let places: Vec<(f64, f64)> = (0..8).map(|i| (0.5 + 0.1 * f64::from(i % 4), 0.1 * f64::from(i / 4))).collect();
    let mut problem = boxes_on_a_table(&places, &places).unwrap();
    let tops = (0..8).map(|i| problem.robot.surface(&format!("box{i}/top")).unwrap());
    problem.graph.supports.extend(tops.collect::<Vec<_>>());
    assert!(matches!(build_constraint_graph(&problem), Err(GraphError::TooManyStates { .. })));
    let mut model = PlanningModel(Arc::new(Model::new(problem).unwrap()));
    let start = model.problem.start.clone();
    let start = model.reach(&start, 1e-4).unwrap();
    assert_eq!(model.graph.state(start).name, "free");
    model.expand(start);
    let held = model.graph.state_named("arm/hand grasps box0/top").unwrap();
    model.expand(held);
    // Onto the table or any of the seven others.
    let releases = model.graph.leaving(held).filter(|(_, t)| t.kind == TransitionKind::Regular);
    assert_eq!(releases.count(), 8);
}
