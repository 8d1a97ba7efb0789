//! Whoever asks for near nodes gets those that measuring every node gives, also once they lie in lanes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::roadmap::{ComponentId, NodeId, Roadmap};
use foliate_components::sample_problems::boxes_on_a_table;
use foliate_systems::model::PlanningModel;
use foliate_systems::neighbours::Neighbours;
use foliate_systems::schedulers::mrrt::Mrrt;
use foliate_systems::settings::{SearchSettings, Selection};

fn all(roadmap: &Roadmap) -> impl Iterator<Item = NodeId> + Clone {
    (0..roadmap.nodes().len() as u32).map(NodeId)
}

/// Measures all nodes of the leaf: by tree, distance, id.
fn scalar_neighbours(model: &PlanningModel, roadmap: &Roadmap, node: NodeId, count: usize) -> Vec<NodeId> {
    let (space, q) = (&model.problem.robot.space, roadmap.configuration(node));
    let own = roadmap.component_of(node);
    let mut others: Vec<(ComponentId, f64, NodeId)> = all(roadmap)
        .filter(|&n| roadmap.node(n).leaf == roadmap.node(node).leaf && roadmap.component_of(n) != own)
        .map(|n| (roadmap.component_of(n), space.distance(q, roadmap.configuration(n), &model.robot_weights), n))
        .collect();
    others.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    others.chunk_by(|a, b| a.0 == b.0).flat_map(|tree| tree.iter().take(count).map(|&(_, _, n)| n)).collect()
}

#[test]
fn nodes_found_in_lanes_are_those_found_one_by_one() {
    // The goal lies out of the arm's reach: two trees grow side by side.
    let model = model(boxes_on_a_table(&[(0.6, 0.1)], &[(1.45, 0.75)]).unwrap());
    for selection in [Selection::Guided, Selection::StateFirst, Selection::Nearest] {
        let settings = SearchSettings { max_steps: 24, selection, ..seeded(7) };
        let (_, search) = search(&model, &Mrrt, settings, 1);
        let (roadmap, neighbours) = (search.roadmap(), search.world().resource::<Neighbours>());
        assert!(neighbours.bytes() > 0, "no leaf has become a crowd");
        for node in all(roadmap) {
            let (row, tree) = (roadmap.node(node), roadmap.component_of(node));
            let q: Vec<f64> = roadmap.configuration(node).iter().map(|x| x * 0.9).collect();
            let in_tree = |born| roadmap.component(born) == tree;
            let of_tree = all(roadmap).filter(|&n| roadmap.component_of(n) == tree);

            let on_leaf = of_tree.clone().filter(|&n| roadmap.node(n).leaf == row.leaf);
            let nearest = model.nearest(roadmap, &q, on_leaf, &model.robot_weights);
            assert_eq!(neighbours.nearest_on(&model, roadmap, &q, row.leaf, in_tree), nearest);

            // A number of a quaternion that shrinks is no rotation: the whole configuration is asked for as it is.
            let q = roadmap.configuration(node);
            let in_state = of_tree.filter(|&n| roadmap.node(n).state == row.state);
            let nearest = model.nearest(roadmap, q, in_state, &model.weights);
            assert_eq!(neighbours.nearest_in(&model, roadmap, q, row.state, in_tree), nearest);
            assert_eq!(
                neighbours.nearest_of_all(&model, roadmap, q),
                model.nearest(roadmap, q, all(roadmap), &model.weights)
            );
            for count in [0, 1, 3] {
                let scalar = scalar_neighbours(&model, roadmap, node, count);
                assert_eq!(neighbours.of_other_trees(&model, roadmap, node, count), scalar);
            }
        }
    }
}
