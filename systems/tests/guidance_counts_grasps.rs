//! Guided selection knows how many changes of grasp part two leaves, and keeps that knowledge right while trees grow.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use bevy_ecs::prelude::Schedule;
use common::{model, search, seeded};
use foliate_components::Pose;
use foliate_components::graph::leaf::{Leaf, LeafIndex, Parameter, ParameterId};
use foliate_components::graph::{ConstraintGraph, StateId, Transition, TransitionKind};
use foliate_components::problem::JointRest;
use foliate_components::roadmap::TreeId;
use foliate_components::samples::{boxes_on_a_table, open_a_drawer, swap_two_boxes};
use foliate_schedulers::mrrt::Mrrt;
use foliate_systems::exploration::reached_leaves::ReachedLeaves;
use foliate_systems::heuristic::grasp_distance::GraspDistance;
use foliate_systems::heuristic::leaf_heuristic::LeafHeuristic;
use foliate_systems::heuristic::systems::measure_leaves;
use foliate_systems::planning_model::PlanningModel;

/// A leaf of the state of that name, with a new value for every foliating constraint.
fn new_leaf(model: &PlanningModel, index: &mut LeafIndex, state: &str) -> Leaf {
    let state = model.graph.state_named(state).unwrap();
    let parameters = model
        .graph
        .state(state)
        .foliation
        .iter()
        .map(|&constraint| index.add_parameter(Parameter { constraint, carrier: None, value: Pose::identity() }));
    let parameters = parameters.collect();
    Leaf { state, parameters }
}

/// The leaf of a neighbouring state that keeps all values that it can.
fn kept(graph: &ConstraintGraph, from: &Leaf, to: StateId) -> Leaf {
    let foliation = &graph.state(to).foliation;
    let parameters: Box<[ParameterId]> = foliation
        .iter()
        .map(|c| from.parameters[graph.state(from.state).foliation.iter().position(|x| x == c).unwrap()])
        .collect();
    Leaf { state: to, parameters }
}

fn transition(graph: &ConstraintGraph, from: StateId, to: StateId, kind: TransitionKind) -> &Transition {
    graph.leaving(from).find(|(_, t)| t.to == to && t.kind == kind).unwrap().1
}

#[test]
fn two_boxes_that_change_places_are_four_grasps_away() {
    let model = model(swap_two_boxes().unwrap());
    let graph = &model.graph;
    let mut index = LeafIndex::default();
    let start = new_leaf(&model, &mut index, "free");
    let goal = new_leaf(&model, &mut index, "free");
    let distance = GraspDistance::new(graph);
    assert_eq!(distance.between(graph, &start, &start), 0);
    assert_eq!(distance.between(graph, &start, &goal), 4, "each box is taken and put down");

    let held = graph.state_named("arm/hand grasps box0/top").unwrap();
    let take = transition(graph, start.state, held, TransitionKind::Regular);
    assert_eq!(distance.after(graph, &start, take, &goal), 3);
    let holding = kept(graph, &start, held);
    assert_eq!(distance.between(graph, &holding, &goal), 3);

    let anywhere = transition(graph, held, goal.state, TransitionKind::Regular);
    let into_place = transition(graph, held, goal.state, TransitionKind::Crossed);
    assert_eq!(distance.after(graph, &holding, anywhere, &goal), 4, "put down elsewhere, it must be taken again");
    assert_eq!(distance.after(graph, &holding, into_place, &goal), 2, "put down where the goal has it");
    let stay = graph.transition(graph.loop_of(held).unwrap());
    assert_eq!(distance.after(graph, &holding, stay, &goal), 3, "motions alone change nothing");
}

#[test]
fn a_box_that_need_not_move_costs_nothing() {
    let model = model(boxes_on_a_table(&[(0.6, 0.1), (0.6, -0.1)], &[(0.7, 0.1), (0.6, -0.1)]).unwrap());
    let graph = &model.graph;
    let mut index = LeafIndex::default();
    let start = new_leaf(&model, &mut index, "free");
    let mut goal = new_leaf(&model, &mut index, "free");
    goal.parameters[1] = start.parameters[1];
    let distance = GraspDistance::new(graph);
    assert_eq!(distance.between(graph, &start, &goal), 2);
    let wrong = graph.state_named("arm/hand grasps box1/top").unwrap();
    let take = transition(graph, start.state, wrong, TransitionKind::Regular);
    assert_eq!(distance.after(graph, &start, take, &goal), 3, "what is in place had better stay");
}

#[test]
fn what_is_kept_while_trees_grow_is_what_counting_afresh_gives() {
    // Of the last one the goal is out of reach, so that its trees stay apart.
    let out_of_reach = boxes_on_a_table(&[(0.6, 0.1), (0.6, -0.1)], &[(1.25, 0.0), (0.6, -0.1)]);
    for problem in [swap_two_boxes(), open_a_drawer(JointRest::Stays, 0.1), out_of_reach] {
        let model = model(problem.unwrap());
        let settings = seeded(3).with(|s| s.max_steps = 8);
        let (_, mut search) = search(&model, &Mrrt, settings, 1);
        // The last step's leaves would be measured at the start of the next.
        let mut measure = Schedule::default();
        measure.add_systems(measure_leaves);
        measure.run(search.world_mut());

        let world = search.world();
        let (heuristic, reached) = (world.resource::<LeafHeuristic>(), world.resource::<ReachedLeaves>());
        let (leaves, roadmap) = (world.resource::<LeafIndex>(), search.roadmap());
        let afresh = GraspDistance::new(&model.graph);
        let trees = (0..roadmap.tree_count() as u32).map(TreeId).filter(|&c| roadmap.tree(c) == c);
        let mut compared = 0;
        for tree in trees {
            let others = (0..).map(TreeId).zip(&reached.by_born_tree);
            let others = others.filter(|&(c, _)| roadmap.tree(c) != tree);
            let others: Vec<_> = others.flat_map(|(_, list)| list).map(|&to| leaves.leaf(to)).collect();
            for &leaf in &reached.by_born_tree[tree.at()] {
                let far = others.iter().map(|to| afresh.between(&model.graph, leaves.leaf(leaf), to)).min();
                assert_eq!(heuristic.to_others(leaf, tree), far.or(Some(0)));
                compared += 1;
            }
        }
        assert!(compared > 1, "{compared} leaves compared in `{}`", model.problem.name);
    }
}
