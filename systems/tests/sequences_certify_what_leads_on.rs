//! The story of the scheduler `sequence`: short motions between leaves are planted without the long motions that lead there,
//! and of the long ones only those are certified that lie on a way from the start to a goal.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::graph::leaf::LeafId;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::Goal;
use foliate_components::roadmap::{ComponentId, EdgeId, NodeId, Roadmap};
use foliate_components::samples::{move_one_box, swap_two_boxes, swap_with_crossed_foliations};
use foliate_systems::exploration::edges::{UnvalidatedEdge, UnvalidatedEdges};
use foliate_systems::exploration::explored::SearchSides;
use foliate_systems::exploration::reached_leaves::ReachedLeaves;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::schedulers::sequence::leaf_graph::LeafGraph;
use foliate_systems::schedulers::{mrrt::Mrrt, sequence::Sequence};
use foliate_systems::search::Search;

fn nodes(roadmap: &Roadmap) -> impl Iterator<Item = NodeId> {
    (0..roadmap.nodes().len() as u32).map(NodeId)
}

/// How many motions were certified that lead farther than a hand's breadth.
fn long_motions(search: &Search) -> usize {
    let roadmap = search.roadmap();
    let motions = (0..roadmap.edges().len() as u32).map(EdgeId);
    motions.flat_map(|edge| roadmap.motions_of(edge)).filter(|m| search.model().length(&m.knots) > 0.3).count()
}

#[test]
fn fewer_long_motions_are_certified() {
    let model = model(swap_two_boxes().unwrap());
    let sum = |scheduler: &dyn foliate_systems::schedulers::Scheduler| -> usize {
        let runs = (1..=6).map(|seed| search(&model, scheduler, seeded(seed), 1));
        runs.map(|(outcome, search)| {
            assert_eq!(outcome, SearchOutcome::Solved);
            long_motions(&search)
        })
        .sum()
    };
    let (lazy, eager) = (sum(&Sequence), sum(&Mrrt));
    assert!(2 * lazy < eager, "{lazy} motions instead of {eager}");
}

#[test]
fn what_was_planted_in_vain_hangs_together_with_nothing() {
    let model = model(swap_two_boxes().unwrap());
    let mut left = 0;
    for seed in 1..=3 {
        let (_, search) = search(&model, &Sequence, seeded(seed), 1);
        let roadmap = search.roadmap();
        let start = roadmap.component_of(search.world().resource::<Roots>().start.unwrap());
        left += nodes(roadmap).filter(|&node| roadmap.component_of(node) != start).count();
        // But its family knows the leaves that it is on.
        let (search_sides, reached) =
            (search.world().resource::<SearchSides>(), search.world().resource::<ReachedLeaves>());
        for node in nodes(roadmap) {
            let row = roadmap.node(node);
            let search_side: ComponentId = search_sides.side_root(row.component);
            assert!(reached.by_component[search_side.at()].contains(&row.leaf));
            assert_eq!(search_sides.side_root(search_side), search_side, "a family's root was planted itself");
        }
    }
    assert!(left > 0, "everything that was planted was joined: nothing was lazy");
}

#[test]
fn of_what_is_planted_only_what_a_sequence_needs_is_certified() {
    let model = model(swap_two_boxes().unwrap());
    let (mut open, mut made) = (0, 0);
    for seed in 1..=3 {
        let (_, search) = search(&model, &Sequence, seeded(seed), 1);
        let (roadmap, unvalidated_edges) = (search.roadmap(), search.world().resource::<UnvalidatedEdges>());
        for node in nodes(roadmap) {
            let Some(unvalidated_edge) = unvalidated_edges.to(node) else { continue };
            open += 1;
            let certified = roadmap.edges_at(node).any(|edge| roadmap.edge(edge).from == unvalidated_edge.from);
            assert!(!certified, "a passage that is an edge");
        }
        let edges = (0..roadmap.edges().len() as u32).map(EdgeId);
        let crosses = |&edge: &EdgeId| {
            let row = roadmap.edge(edge);
            roadmap.node(row.from).leaf != roadmap.node(row.to).leaf && row.motions > 0
        };
        made += edges.filter(crosses).count();
        assert!(unvalidated_edges.bytes() > 0 || unvalidated_edges.is_empty());
    }
    assert!(open > made, "{open} passages were left alone, {made} certified");
}

#[test]
fn motions_on_one_leaf_need_nothing_planted() {
    let mut problem = move_one_box().unwrap();
    let mut goal = problem.start.clone();
    (goal[0], goal[1], goal[3]) = (1.2, -0.2, 1.0);
    problem.goals = vec![Goal::Configuration(goal)];
    let (outcome, search) = search(&model(problem), &Sequence, seeded(1), 1);
    assert_eq!(outcome, SearchOutcome::Solved);
    assert!(search.path().unwrap().segments.iter().all(|s| s.state == search.path().unwrap().segments[0].state));
}

#[test]
fn paths_pass_through_every_state_that_they_touch() {
    // Grasps without a motion of their own are entered and left at once; the path has to say so all the same.
    let model = model(swap_with_crossed_foliations().unwrap());
    for seed in 1..=4 {
        let (outcome, search) = search(&model, &Sequence, seeded(seed), 2);
        assert_eq!(outcome, SearchOutcome::Solved);
        let path = search.path().unwrap();
        for pair in path.segments.windows(2) {
            let (a, b) = (&search.model().graph.state(pair[0].state), &search.model().graph.state(pair[1].state));
            let changed = a.grasps.iter().filter(|g| !b.grasps.contains(g)).count()
                + b.grasps.iter().filter(|g| !a.grasps.contains(g)).count();
            assert!(changed <= 1, "{} is followed by {}", a.name, b.name);
        }
    }
}

/// Adds a node at the start of [`move_one_box`], but for the first number, which is `at`.
fn add(roadmap: &mut Roadmap, at: f64, leaf: u32, tree: Option<ComponentId>) -> NodeId {
    let mut q = move_one_box().unwrap().start;
    q[0] = at;
    roadmap.add_node(&q, StateId(leaf), LeafId(leaf), tree)
}

/// Adds a chain from leaf 0 to leaf 1; returns its two ends.
fn add_chain(roadmap: &mut Roadmap, at: f64) -> (NodeId, NodeId) {
    let enters = add(roadmap, at, 0, None);
    let tree = roadmap.component_of(enters);
    let leaves = add(roadmap, at, 1, Some(tree));
    roadmap.add_edge(enters, leaves, TransitionId(0), Vec::new());
    (enters, leaves)
}

#[test]
fn a_way_that_fails_makes_room_for_another_and_is_not_given_up() {
    let space = move_one_box().unwrap().robot.space;
    let mut roadmap = Roadmap::new(space.size());
    let (start, goal) = (add(&mut roadmap, 0.0, 0, None), add(&mut roadmap, 0.0, 1, None));
    let roots = Roots { start: Some(start), goals: vec![goal] };
    let mut graph = LeafGraph::default();
    let weights = vec![1.0; space.dimension()];
    graph.grow(&roadmap, &UnvalidatedEdges::default(), &space, &weights);
    assert_eq!(graph.cheapest(&roadmap, &roots), None, "two leaves with nothing between them");

    let (near, far) = (add_chain(&mut roadmap, 0.1), add_chain(&mut roadmap, 1.0));
    graph.grow(&roadmap, &UnvalidatedEdges::default(), &space, &weights);
    let ends = |graph: &LeafGraph| -> Vec<_> {
        graph.cheapest(&roadmap, &roots).unwrap().into_iter().map(|join| graph.ends(join)).collect()
    };
    assert_eq!(ends(&graph), [(start, near.0), (goal, near.1)]);
    // Its first motion fails, and in the end the other way's does too.
    let mut ways = Vec::new();
    for _ in 0..40 {
        let way = graph.cheapest(&roadmap, &roots).unwrap();
        ways.push(graph.ends(way[0]).1);
        graph.count_tried(way[0], false);
    }
    assert!(ways[..4].contains(&far.0), "the other way was not tried");
    assert!(ways[20..].contains(&near.0), "the first way was given up");

    // Where start and goal hang together nothing is missing.
    roadmap.add_edge(start, goal, TransitionId(0), Vec::new());
    assert_eq!(graph.cheapest(&roadmap, &roots), Some(Vec::new()));
}

#[test]
fn a_passage_is_a_way_until_it_is_known_not_to_be_free() {
    let space = move_one_box().unwrap().robot.space;
    let mut roadmap = Roadmap::new(space.size());
    let mut unvalidated_edges = UnvalidatedEdges::default();
    let (start, goal) = (add(&mut roadmap, 0.0, 0, None), add(&mut roadmap, 0.0, 1, None));
    let roots = Roots { start: Some(start), goals: vec![goal] };
    let mut plant = |roadmap: &mut Roadmap, at: f64| {
        let (from, to) = (add(roadmap, at, 0, None), add(roadmap, at, 1, None));
        let unvalidated_edge = UnvalidatedEdge { from, transition: TransitionId(0), drawn: None, motions: Vec::new() };
        unvalidated_edges.add(to, unvalidated_edge);
        (from, to)
    };
    let (near, far) = (plant(&mut roadmap, 0.1), plant(&mut roadmap, 1.0));
    let mut graph = LeafGraph::default();
    graph.grow(&roadmap, &unvalidated_edges, &space, &vec![1.0; space.dimension()]);
    let way = graph.cheapest(&roadmap, &roots).unwrap();
    let ends: Vec<_> = way.iter().map(|&join| graph.ends(join)).collect();
    assert_eq!(ends, [(start, near.0), near, (goal, near.1)]);
    assert_eq!(way.iter().map(|&join| graph.is_unvalidated(join)).collect::<Vec<_>>(), [false, true, false]);
    assert!(graph.cost(way[1]) < graph.cost(way[0]), "passages come last");

    graph.count_tried(way[1], false);
    let way = graph.cheapest(&roadmap, &roots).unwrap();
    assert_eq!(graph.ends(way[1]), far, "what is not free is no way");
    graph.count_tried(way[1], false);
    assert_eq!(graph.cheapest(&roadmap, &roots), None, "nothing is left");
}
