//! A query for near nodes gets those that measuring every node gives, also from lanes, and whatever other queries share its pass.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{Unconnected, model, search, seeded};
use foliate_components::graph::TransitionId;
use foliate_components::roadmap::{NodeId, Roadmap, TreeId};
use foliate_components::samples::boxes_on_a_table;
use foliate_schedulers::{Scheduler, sequence::Sequence};
use foliate_systems::exploration::neighbours::{Neighbours, Question, Region};
use foliate_systems::exploration::writer;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::settings::Selection;

fn all(roadmap: Roadmap<'_>) -> impl Iterator<Item = NodeId> + Clone {
    (0..roadmap.nodes().len() as u32).map(NodeId)
}

/// Measures all nodes of the leaf: by tree, distance, id.
fn scalar_neighbours(model: &PlanningModel, roadmap: Roadmap<'_>, node: NodeId, count: usize) -> Vec<NodeId> {
    let (space, q) = (&model.problem.robot.space, roadmap.configuration(node));
    let own = roadmap.tree_of(node);
    let mut others: Vec<(TreeId, f64, NodeId)> = all(roadmap)
        .filter(|&n| roadmap.node(n).leaf == roadmap.node(node).leaf && roadmap.tree_of(n) != own)
        .map(|n| (roadmap.tree_of(n), space.distance(q, roadmap.configuration(n), &model.robot_weights), n))
        .collect();
    others.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    others.chunk_by(|a, b| a.0 == b.0).flat_map(|tree| tree.iter().take(count).map(|&(_, _, n)| n)).collect()
}

/// What is asked about a node's surroundings, and the answer of measuring everything.
fn questions<'q>(
    (model, roadmap): (&PlanningModel, Roadmap<'_>),
    (node, q): (NodeId, &'q [f64]),
    shrunk: &'q [f64],
) -> Vec<Question<'q>> {
    let (row, tree) = (roadmap.node(node), roadmap.tree_of(node));
    let ask = |region, tree: Option<TreeId>, q: &'q [f64]| {
        let lies_here = |&n: &NodeId| match region {
            Region::Leaf(leaf) => roadmap.node(n).leaf == leaf,
            Region::State(state) => roadmap.node(n).state == state,
            Region::Roadmap => true,
        };
        let weights = if matches!(region, Region::Leaf(_)) { &model.robot_weights } else { &model.weights };
        let nodes = all(roadmap).filter(lies_here).filter(|&n| tree.is_none_or(|t| roadmap.tree_of(n) == t));
        Question { asker: 0, region, tree, q, nearest: model.nearest(roadmap, q, nodes, weights) }
    };
    vec![
        // A number of a quaternion that shrinks is no rotation: the whole configuration is asked for as it is.
        ask(Region::Leaf(row.leaf), Some(tree), shrunk),
        ask(Region::State(row.state), Some(tree), q),
        ask(Region::Roadmap, None, q),
        ask(Region::Leaf(row.leaf), None, shrunk),
        // At the node itself, and again: ties.
        ask(Region::Leaf(row.leaf), Some(tree), q),
        ask(Region::Leaf(row.leaf), Some(tree), q),
        // No node is in that tree.
        ask(Region::Leaf(row.leaf), Some(TreeId(1_000_000)), q),
    ]
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

fn busiest_leaf(roadmap: Roadmap<'_>) -> Vec<NodeId> {
    let leaves = all(roadmap).map(|node| roadmap.nodes_on(roadmap.node(node).leaf));
    leaves.max_by_key(|nodes| nodes.len()).unwrap_or_default().to_vec()
}

#[test]
fn nodes_found_in_lanes_are_those_found_one_by_one() {
    let model = model(boxes_on_a_table(&[(0.6, 0.1)], &[(0.6, 0.1)]).unwrap());
    // Of a problem that has no solution: many trees of the lazy extension on one leaf.
    let unsolvable = self::model(boxes_on_a_table(&[(0.6, 0.1)], &[(1.25, 0.0)]).unwrap());
    let apart = [Selection::Guided, Selection::StateFirst, Selection::Nearest].map(|s| (&model, &Unconnected as _, s));
    let lazy: [(_, &dyn Scheduler, _); 1] = [(&unsolvable, &Sequence, Selection::Guided)];
    for (model, scheduler, selection) in apart.into_iter().chain(lazy) {
        let settings = seeded(7).with(|s| (s.max_steps, s.selection) = (40, selection));
        let (_, mut search) = search(model, scheduler, settings, 1);
        let crowd = busiest_leaf(search.roadmap());
        assert!(crowd.len() > 40, "no leaf has become a crowd");
        // Of the trees of the lazy extension some are connected.
        if scheduler.name() == "sequence" {
            crowd.windows(9).step_by(2).for_each(|near| {
                writer::add_edge(search.world_mut(), (near[0], near[8]), TransitionId(0), Vec::new());
            });
        }
        let (roadmap, neighbours) = (search.roadmap(), search.world().resource::<Neighbours>());
        assert!(neighbours.bytes() > 0);

        let shrunk: Vec<Vec<f64>> =
            all(roadmap).map(|n| roadmap.configuration(n).iter().map(|x| x * 0.9).collect()).collect();
        let surroundings =
            |node: NodeId| questions((model, roadmap), (node, roadmap.configuration(node)), &shrunk[node.at()]);
        let mut scalar: Vec<_> = all(roadmap).flat_map(surroundings).collect();
        scalar.iter_mut().enumerate().for_each(|(asker, question)| question.asker = asker);
        let tree_of = |born| roadmap.tree(born);
        for (together, threads) in [(1, 1), (3, 1), (60, 1), (scalar.len(), 1), (60, 2), (scalar.len(), 3)] {
            let mut asked: Vec<_> = scalar.iter().map(|q| Question { nearest: None, ..q.clone() }).collect();
            on_threads(threads, || {
                let batches = asked.chunks_mut(together);
                batches.for_each(|batch| neighbours.answer(model, roadmap, batch, tree_of));
            });
            for batch in asked.chunks(together) {
                let order = |q: &Question<'_>| (q.region, q.tree, q.asker);
                assert!(batch.is_sorted_by_key(order));
            }
            asked.iter().for_each(|q| assert_eq!(q.nearest, scalar[q.asker].nearest, "{q:?}, {together} together"));
        }
        neighbours.answer(model, roadmap, &mut [], tree_of);

        let nodes: Vec<_> = all(roadmap).collect();
        for count in [0, 1, 3] {
            let others =
                |&node: &NodeId| scalar_neighbours(model, roadmap, node, count).into_iter().map(move |o| (node, o));
            let scalar: Vec<_> = nodes.iter().flat_map(others).collect();
            assert_eq!(scalar.is_empty(), count == 0, "no two trees have met on a leaf");
            for (together, threads) in [(1, 1), (5, 1), (nodes.len(), 1), (nodes.len(), 3)] {
                let of = |nodes: &[NodeId]| neighbours.of_other_trees(model, roadmap, nodes, count);
                let found: Vec<_> = on_threads(threads, || nodes.chunks(together).flat_map(of).collect());
                assert_eq!(found, scalar, "{together} together");
            }
        }
        assert_eq!(neighbours.of_other_trees(model, roadmap, &[], 3), []);
    }
}
