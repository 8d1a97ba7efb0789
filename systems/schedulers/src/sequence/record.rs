//! What sequences grow on: the leaves that are nearest to the other side are proved to be reached before much grows behind them.
//!
//! A long sequence of unvalidated edges is hardly ever free of collisions as a whole, and what lies behind one that is none is lost. So
//! whenever a side of the search has come closer to the other, the unvalidated edges that lead there are certified. The
//! answer will most often need them.

use crate::sequence::joining::Tried;
use crate::sequence::leaf_graph::LeafGraph;
use bevy_ecs::prelude::{Res, ResMut, Resource};
use foliate_components::graph::leaf::LeafId;
use foliate_components::roadmap::TreeId;
use foliate_systems::exploration::edges::{Connection, Connections};
use foliate_systems::exploration::explored::Explored;
use foliate_systems::exploration::reached_leaves::ReachedLeaves;
use foliate_systems::exploration::roadmap_query::RoadmapQuery;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::exploration::writer;
use foliate_systems::heuristic::leaf_heuristic::LeafHeuristic;
use foliate_components::graph::leaf::LeafIndex;
use std::collections::{BTreeMap, HashSet};

/// A record is proved where it is closer than the last one by so many changes of grasp: two objects moved.
const CLOSER: u16 = 4;

/// By side: how far the nearest leaf was that was proved.
#[derive(Clone, Debug, Default, Resource)]
pub struct Records(BTreeMap<TreeId, u16>);

/// Where nothing else is proposed: proposes the unvalidated edges that lead to leaves which have come closer to another side.
pub fn propose_records(
    explored: Explored<'_, '_>,
    heuristic: Res<'_, LeafHeuristic>,
    roots: Res<'_, Roots>,
    graph: Res<'_, LeafGraph>,
    mut records: ResMut<'_, Records>,
    mut tried: ResMut<'_, Tried>,
    mut connections: ResMut<'_, Connections>,
) {
    if !connections.0.is_empty() {
        return;
    }
    let roadmap = explored.roadmap();
    for &root in roots.start.iter().chain(&roots.goals) {
        let side = roadmap.side_of(root);
        let Some((far, leaf)) = heuristic.nearest_to_others(side) else { continue };
        let record = records.0.entry(side).or_insert(far);
        *record = (*record).max(far.saturating_sub(1));
        if *record < far + CLOSER {
            continue;
        }
        *record = far;
        let way = graph.cheapest_to_leaf(roadmap, root, leaf).unwrap_or_default();
        for join in way.into_iter().filter(|&join| graph.is_unvalidated(join)) {
            let (from, to) = graph.ends(join);
            connections.0.push(Connection::between(from, to));
            tried.0.push(Some(join));
        }
    }
}

/// Takes what no joins lead to any more out of what the trees have reached: nothing is gained there, however near it is.
pub fn forget_lost(
    roadmap: RoadmapQuery<'_, '_>,
    roots: Res<'_, Roots>,
    leaves: Res<'_, LeafIndex>,
    mut graph: ResMut<'_, LeafGraph>,
    mut reached: ResMut<'_, ReachedLeaves>,
) {
    if !graph.take_broken() {
        return;
    }
    let roadmap = roadmap.view();
    let connected = graph.connected(roadmap, &roots);
    let is_kept = |tree: TreeId| connected[roadmap.tree(tree).at()];
    let of_nodes = |kept: bool| -> HashSet<(TreeId, LeafId)> {
        let nodes = roadmap.nodes().iter().filter(|row| is_kept(row.tree) == kept);
        nodes.map(|row| (roadmap.side(row.tree), row.leaf)).collect()
    };
    let (kept, mut lost) = (of_nodes(true), of_nodes(false));
    lost.retain(|leaf| !kept.contains(leaf));
    // Mostly another way leads there.
    if graph.lose(lost) {
        writer::visit_again(&mut reached, roadmap, &leaves, is_kept);
    }
}
