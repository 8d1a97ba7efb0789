//! The constraint graph of P1 Algorithm 1: which states and transitions there are, how they are called, where crossed
//! transitions stand, what restricts them, and that one built by hand serves as well.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{search, seeded};
use foliate_components::graph::{ConstraintGraph, TransitionKind};
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::{Problem, Rule};
use foliate_components::robot::{Gripper, GripperIndex};
use foliate_components::sample_problems::{boxes_on_a_table, swap_two_boxes};
use foliate_systems::graph_building::{GraphError, build_constraint_graph};
use foliate_systems::model::{Model, PlanningModel};
use foliate_systems::schedulers::mrrt::Mrrt;
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
fn graphs_that_nobody_could_search_are_refused_with_a_sentence() {
    let places: Vec<(f64, f64)> = (0..8).map(|i| (0.5 + 0.1 * f64::from(i % 4), 0.1 * f64::from(i / 4))).collect();
    let mut problem = boxes_on_a_table(&places, &places).unwrap();
    for number in 0..7 {
        let hand = problem.robot.grippers[0].clone();
        problem.robot.grippers.push(Gripper { name: format!("arm/hand{number}"), ..hand });
        problem.graph.grippers.push(GripperIndex(problem.robot.grippers.len() as u32 - 1));
    }
    let error = build_constraint_graph(&problem).unwrap_err();
    assert_eq!(error, GraphError::TooManyStates { grippers: 8, handles: 8 });
    assert!(error.to_string().contains("name the grasps that may occur"));
}

#[test]
fn a_graph_by_hand_is_searched_as_well() {
    let problem = swap_two_boxes().unwrap();
    let mut graph = build_constraint_graph(&problem).unwrap();
    // Without the crossed transitions the trees meet only in states of one leaf; the swap has none on its way.
    graph.transitions.retain(|t| t.kind != TransitionKind::Crossed);
    graph.transitions.iter_mut().for_each(|t| t.reverse = None);
    let model = PlanningModel(Arc::new(Model::with_graph(problem, graph).unwrap()));
    let settings = foliate_systems::settings::SearchSettings { max_steps: 20, ..seeded(1) };
    assert_eq!(search(&model, &Mrrt, settings, 1).0, SearchOutcome::StepLimit);
}
