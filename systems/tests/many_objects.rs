//! Many objects on a table: what the search does about their number. `benches/src/bin/rearrangement` measures it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use bevy_ecs::prelude::{Mut, Schedule};
use common::{model, search, seeded};
use foliate_components::graph::ConstraintKind;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::Problem;
use foliate_components::roadmap::TreeId;
use foliate_components::samples::rearrangements::rearrange_boxes;
use foliate_schedulers::sequence::Sequence;
use foliate_systems::exploration::reached_leaves::ReachedLeaves;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::heuristic::blocking::MoveOrder;
use foliate_systems::heuristic::grasp_distance::GraspDistance;
use foliate_systems::heuristic::leaf_heuristic::LeafHeuristic;
use foliate_systems::heuristic::systems::measure_leaves;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::Search;

/// A row of places; box i stands on place i, and its goal is place i + 1. Where `round`, the last one's is the first place.
fn in_a_row(arms: usize, boxes: usize, round: bool) -> Problem {
    let place = |number: usize| (0.1 * (number % 5) as f64 - 0.2, -0.15 + 0.1 * (number / 5) as f64);
    let starts: Vec<_> = (0..boxes).map(place).collect();
    let goals: Vec<_> = (1..=boxes).map(|next| place(if round { next % boxes } else { next })).collect();
    rearrange_boxes(arms, (1.7, 1.7), &starts, &goals).unwrap()
}

/// How often something is taken hold of along the path.
fn grasps(search: &Search) -> usize {
    let graph = &search.model().graph;
    let held = |state| {
        let constraints = graph.state(state).manifold.iter();
        constraints.filter(|&&c| matches!(graph.constraint(c).kind, ConstraintKind::Grasp { .. })).count()
    };
    let path = search.path().unwrap();
    path.segments.windows(2).map(|pair| held(pair[1].state).saturating_sub(held(pair[0].state))).sum()
}

#[test]
fn ten_boxes_are_moved_within_few_steps() {
    for (arms, round) in [(1, false), (1, true), (2, false)] {
        let model = model(in_a_row(arms, 10, round));
        for seed in 1..=3 {
            let (outcome, search) = search(&model, &Sequence, seeded(seed).with(|s| s.max_steps = 300), 1);
            assert_eq!(outcome, SearchOutcome::Solved, "{arms} arms, round: {round}, seed {seed}");
            let grasps = grasps(&search);
            assert!((10..=20).contains(&grasps), "{grasps} grasps, {arms} arms, round: {round}, seed {seed}");
        }
    }
}

#[test]
fn lost_leaves_depend_on_no_thread() {
    // So close that short motions often collide, and what lies behind them is lost.
    let place = |number: usize| (0.055 * (number % 4) as f64 - 0.08, 0.055 * (number / 4) as f64 - 0.1);
    let starts: Vec<_> = (0..9).map(place).collect();
    let goals: Vec<_> = (0..9).map(|number| place(8 - number)).collect();
    let model = model(rearrange_boxes(1, (0.3, 0.3), &starts, &goals).unwrap());
    for seed in 1..=2 {
        let settings = seeded(seed).with(|s| s.max_steps = 60);
        let (outcome, one) = search(&model, &Sequence, settings.clone(), 1);
        let (other, two) = search(&model, &Sequence, settings, 2);
        assert_eq!(outcome, other);
        assert_eq!(one.roadmap().fingerprint(), two.roadmap().fingerprint(), "seed {seed}");
        assert_eq!(one.path(), two.path());
        is_measured_as_afresh(&model, one);
    }
}

/// Distances that were kept while leaves were lost are those that are found anew.
fn is_measured_as_afresh(model: &PlanningModel, mut search: Search) {
    let mut measure = Schedule::default();
    measure.add_systems(measure_leaves);
    measure.run(search.world_mut());
    let world = search.world();
    let (heuristic, reached) = (world.resource::<LeafHeuristic>(), world.resource::<ReachedLeaves>());
    let (leaves, roadmap) = (world.resource::<LeafIndex>(), search.roadmap());
    let afresh = GraspDistance::new(&model.graph);
    let lists = || (0..).map(TreeId).zip(&reached.by_born_tree);
    for (born, list) in lists() {
        let tree = roadmap.tree(born);
        let others = lists().filter(|&(other, _)| roadmap.tree(other) != tree).flat_map(|(_, list)| list);
        let others: Vec<_> = others.map(|&to| leaves.leaf(to)).collect();
        for &leaf in list {
            let far = others.iter().map(|to| afresh.between(&model.graph, leaves.leaf(leaf), to)).min();
            assert_eq!(heuristic.to_others(leaf, tree), far.or(Some(0)));
        }
    }
}

#[test]
fn what_has_to_move_is_tried_as_often_as_all_else() {
    let model = model(in_a_row(1, 12, false));
    let (_, search) = search(&model, &Sequence, seeded(1).with(|s| s.max_steps = 20), 1);
    let world = search.world();
    let (heuristic, reached) = (world.resource::<LeafHeuristic>(), world.resource::<ReachedLeaves>());
    let (leaves, graph) = (world.resource::<LeafIndex>(), &model.graph);
    let distance = GraspDistance::new(graph);
    let all: Vec<_> = reached.by_born_tree.iter().flatten().map(|&id| leaves.leaf(id)).collect();
    assert!(all.len() > 20);
    for (number, from) in all.iter().enumerate() {
        let to = all[(number * 7 + 3) % all.len()];
        let leaving = || graph.leaving(from.state).map(|(_, transition)| transition);
        let one_by_one: Vec<u16> = leaving().map(|t| distance.after(graph, from, t, to)).collect();
        assert_eq!(distance.after_each(graph, from, to, leaving()), one_by_one);
        let preferences = heuristic.preferences(graph, from, to, leaving());
        let nearest = one_by_one.iter().min().unwrap();
        let share = |wanted: bool| -> f64 {
            let pairs = preferences.iter().zip(&one_by_one);
            pairs.filter(|(_, far)| (*far == nearest) == wanted).map(|(preference, _)| preference).sum()
        };
        assert!((share(true) - 1.0).abs() < 1e-9 && share(false) < 1.0 + 1e-9, "{} and {}", share(true), share(false));
    }
}

/// By box: how much likelier it is taken at the start, by what stands in its way and what it stands in the way of.
fn likelihood_of_taking(model: &PlanningModel, boxes: usize) -> Vec<f64> {
    let (_, mut search) = search(model, &Sequence, seeded(1).with(|s| s.max_steps = 2), 1);
    let roots = search.world().resource::<Roots>().clone();
    let [start, goal] = [roots.start.unwrap(), roots.goals[0]].map(|root| search.roadmap().node(root).leaf);
    let graph = &model.graph;
    let placed = |number: usize| {
        let wanted = ConstraintKind::Placement { object: number as u32, on: None };
        graph.constraints.iter().position(|c| c.kind == wanted).unwrap()
    };
    search.world_mut().resource_scope(|world, mut order: Mut<'_, MoveOrder>| {
        let leaves = world.resource::<LeafIndex>();
        let ends = (leaves.leaf(start), leaves.leaf(goal));
        let leaving = || graph.leaving(ends.0.state);
        let preferences = order.preferences(model, leaves, ends, leaving()).unwrap();
        let taking = |number: usize| {
            let takes = |state| !graph.state(state).foliation.iter().any(|c| c.at() == placed(number));
            let mut found = leaving().zip(&preferences).filter(|((_, transition), _)| takes(transition.to));
            *found.next().unwrap().1
        };
        (0..boxes).map(taking).collect()
    })
}

#[test]
fn what_waits_for_nothing_is_taken_first_and_one_of_a_cycle_is_set_aside() {
    let chain = likelihood_of_taking(&model(in_a_row(1, 6, false)), 6);
    assert!(chain[..5].iter().all(|&weight| weight < 0.1) && chain[5] > 0.99, "{chain:?}");
    let cycle = likelihood_of_taking(&model(in_a_row(1, 6, true)), 6);
    assert_eq!(cycle.iter().filter(|&&weight| weight > 0.99).count(), 1, "{cycle:?}");
    assert_eq!(cycle.iter().filter(|&&weight| weight < 0.1).count(), 5, "{cycle:?}");
}

#[test]
fn a_cycle_of_boxes_takes_one_grasp_more_than_there_are_boxes() {
    for seed in 1..=3 {
        let (outcome, search) =
            search(&model(in_a_row(1, 10, true)), &Sequence, seeded(seed).with(|s| s.max_steps = 100), 1);
        assert_eq!(outcome, SearchOutcome::Solved, "seed {seed}");
        let grasps = grasps(&search);
        assert!((11..=13).contains(&grasps), "{grasps} grasps, seed {seed}");
    }
}

#[test]
fn dense_boxes_are_sorted_within_few_steps() {
    // Fifteen boxes on twenty places, 12 mm apart; the goal turns the table round.
    let place = |number: usize| (0.052 * (number % 5) as f64 - 0.104, 0.052 * (number / 5) as f64 - 0.08);
    let starts: Vec<_> = (0..15).map(place).collect();
    let goals: Vec<_> = (0..15).map(|number| place(19 - number)).collect();
    let model = model(rearrange_boxes(1, (0.3, 0.3), &starts, &goals).unwrap());
    let steps = |seed: u64| {
        let (outcome, search) = search(&model, &Sequence, seeded(seed).with(|s| s.max_steps = 100), 1);
        (outcome == SearchOutcome::Solved).then_some(search.counter().step)
    };
    let steps: Vec<Option<u64>> = (1..=6).map(steps).collect();
    assert!(steps.iter().flatten().count() >= 5, "{steps:?}");
}
