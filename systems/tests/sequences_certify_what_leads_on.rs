//! The story of the scheduler `sequence`: trees are extended lazily, by short motions between leaves without the long motions that
//! lead there. Of the long ones only those are certified that are on a way from the start to a goal.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::graph::leaf::LeafId;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::Goal;
use foliate_components::roadmap::{
    EdgeId, NodeId, Roadmap, RoadmapEdge, RoadmapNode, RoadmapStore, TreeId, UnvalidatedEdge,
};
use foliate_components::samples::{move_one_box, swap_two_boxes, swap_with_crossed_foliations};
use foliate_schedulers::sequence::leaf_graph::LeafGraph;
use foliate_schedulers::{mrrt::Mrrt, sequence::Sequence};
use foliate_systems::exploration::edges::UnvalidatedByEnd;
use foliate_systems::exploration::reached_leaves::ReachedLeaves;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::search::Search;

fn nodes(roadmap: Roadmap<'_>) -> impl Iterator<Item = NodeId> {
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
    let sum = |scheduler: &dyn foliate_schedulers::Scheduler| -> usize {
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
fn what_no_way_needs_stays_unconnected() {
    let model = model(swap_two_boxes().unwrap());
    let mut left = 0;
    for seed in 1..=3 {
        let (_, search) = search(&model, &Sequence, seeded(seed), 1);
        let roadmap = search.roadmap();
        let start = roadmap.tree_of(search.world().resource::<Roots>().start.unwrap());
        left += nodes(roadmap).filter(|&node| roadmap.tree_of(node) != start).count();
        // But its search side knows the leaves that it is on.
        let reached = search.world().resource::<ReachedLeaves>();
        for node in nodes(roadmap) {
            let row = roadmap.node(node);
            assert!(reached.by_born_tree[row.side.at()].contains(&row.leaf));
            let root = roadmap.nodes().iter().find(|other| other.tree == row.side).unwrap();
            assert_eq!(root.side, row.side, "the tree of a start or a goal grows for itself");
        }
    }
    assert!(left > 0, "every lazy extension was connected: nothing was lazy");
}

#[test]
fn of_unvalidated_edges_only_those_on_a_way_are_certified() {
    let model = model(swap_two_boxes().unwrap());
    let (mut open, mut made) = (0, 0);
    for seed in 1..=3 {
        let (_, mut search) = search(&model, &Sequence, seeded(seed), 1);
        let mut unvalidated = search.world_mut().query::<&UnvalidatedEdge>();
        let roadmap = search.roadmap();
        for edge in unvalidated.iter(search.world()) {
            open += 1;
            let validated = roadmap.edges_at(edge.to).any(|id| roadmap.edge(id).from == edge.from);
            assert!(!validated, "an edge that is both");
        }
        let edges = (0..roadmap.edges().len() as u32).map(EdgeId);
        let crosses = |&edge: &EdgeId| {
            let row = roadmap.edge(edge);
            roadmap.node(row.from).leaf != roadmap.node(row.to).leaf && row.motions > 0
        };
        made += edges.filter(crosses).count();
        let by_end = search.world().resource::<UnvalidatedByEnd>();
        assert!(by_end.bytes() > 0 || by_end.is_empty());
    }
    assert!(open > made, "{open} edges were left unvalidated, {made} certified");
}

#[test]
fn motions_on_one_leaf_need_no_lazy_extension() {
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

/// A roadmap without a world.
struct Drawn {
    store: RoadmapStore,
    nodes: Vec<RoadmapNode>,
    edges: Vec<RoadmapEdge>,
    unvalidated: Vec<(NodeId, NodeId)>,
}

impl Drawn {
    fn new(size: usize) -> Self {
        Self { store: RoadmapStore::new(size), nodes: Vec::new(), edges: Vec::new(), unvalidated: Vec::new() }
    }

    /// Adds a node at the start of [`move_one_box`], but for the first number, which is `at`.
    fn add(&mut self, at: f64, leaf: u32, tree: Option<TreeId>) -> NodeId {
        let mut q = move_one_box().unwrap().start;
        q[0] = at;
        let tree = tree.unwrap_or(self.store.next_tree());
        let node = RoadmapNode { state: StateId(leaf), leaf: LeafId(leaf), tree, side: tree };
        self.nodes.push(node);
        self.store.push_node(&q, &node)
    }

    fn add_edge(&mut self, from: NodeId, to: NodeId) {
        let born = (self.nodes[from.at()].tree, self.nodes[to.at()].tree);
        self.edges.push(self.store.push_edge((from, to), born, TransitionId(0), Vec::new()).1);
    }

    /// Adds a chain from leaf 0 to leaf 1; returns its two ends.
    fn add_chain(&mut self, at: f64) -> (NodeId, NodeId) {
        let enters = self.add(at, 0, None);
        let leaves = self.add(at, 1, Some(self.nodes[enters.at()].tree));
        self.add_edge(enters, leaves);
        (enters, leaves)
    }

    /// The same with an unvalidated edge between two trees.
    fn add_unvalidated(&mut self, at: f64) -> (NodeId, NodeId) {
        let ends = (self.add(at, 0, None), self.add(at, 1, None));
        self.unvalidated.push(ends);
        ends
    }

    fn view(&self) -> Roadmap<'_> {
        Roadmap::new(&self.store, &self.nodes, &self.edges, &[])
    }

    fn grow(&self, graph: &mut LeafGraph) {
        let space = move_one_box().unwrap().robot.space;
        let start_of = |node| self.unvalidated.iter().find(|(_, to)| *to == node).map(|&(from, _)| from);
        graph.grow(self.view(), start_of, &space, &vec![1.0; space.dimension()]);
    }
}

#[test]
fn a_way_that_fails_makes_room_for_another_and_is_not_given_up() {
    let space = move_one_box().unwrap().robot.space;
    let mut roadmap = Drawn::new(space.size());
    let (start, goal) = (roadmap.add(0.0, 0, None), roadmap.add(0.0, 1, None));
    let roots = Roots { start: Some(start), goals: vec![goal] };
    let mut graph = LeafGraph::default();
    roadmap.grow(&mut graph);
    assert_eq!(graph.cheapest(roadmap.view(), &roots), None, "two leaves with nothing between them");

    let (near, far) = (roadmap.add_chain(0.1), roadmap.add_chain(1.0));
    roadmap.grow(&mut graph);
    let ends = |graph: &LeafGraph| -> Vec<_> {
        graph.cheapest(roadmap.view(), &roots).unwrap().into_iter().map(|join| graph.ends(join)).collect()
    };
    assert_eq!(ends(&graph), [(start, near.0), (goal, near.1)]);
    // Its first motion fails, and in the end the other way's does too.
    let mut ways = Vec::new();
    for _ in 0..40 {
        let way = graph.cheapest(roadmap.view(), &roots).unwrap();
        ways.push(graph.ends(way[0]).1);
        graph.count_tried(way[0], false);
    }
    assert!(ways[..4].contains(&far.0), "the other way was not tried");
    assert!(ways[20..].contains(&near.0), "the first way was given up");

    // Where start and goal are connected nothing is missing.
    roadmap.add_edge(start, goal);
    assert_eq!(graph.cheapest(roadmap.view(), &roots), Some(Vec::new()));
}

#[test]
fn an_unvalidated_edge_is_a_way_until_it_is_known_not_to_be_free() {
    let space = move_one_box().unwrap().robot.space;
    let mut roadmap = Drawn::new(space.size());
    let (start, goal) = (roadmap.add(0.0, 0, None), roadmap.add(0.0, 1, None));
    let roots = Roots { start: Some(start), goals: vec![goal] };
    let (near, far) = (roadmap.add_unvalidated(0.1), roadmap.add_unvalidated(1.0));
    let mut graph = LeafGraph::default();
    roadmap.grow(&mut graph);
    let way = graph.cheapest(roadmap.view(), &roots).unwrap();
    let ends: Vec<_> = way.iter().map(|&join| graph.ends(join)).collect();
    assert_eq!(ends, [(start, near.0), near, (goal, near.1)]);
    assert_eq!(way.iter().map(|&join| graph.is_unvalidated(join)).collect::<Vec<_>>(), [false, true, false]);
    assert!(graph.cost(way[1]) < graph.cost(way[0]), "unvalidated edges come last");

    graph.count_tried(way[1], false);
    let way = graph.cheapest(roadmap.view(), &roots).unwrap();
    assert_eq!(graph.ends(way[1]), far, "what is not free is no way");
    graph.count_tried(way[1], false);
    assert_eq!(graph.cheapest(roadmap.view(), &roots), None, "nothing is left");
}
