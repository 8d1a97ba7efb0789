//! What long sequences are built on: the leaves that most candidates start from are proved to be reached.
//!
//! A long sequence of unvalidated edges is hardly ever free of collisions as a whole, and what lies behind one that is none is lost. So
//! where a side of the search has come some changes of grasp closer to the other, the unvalidated edges that lead to the leaf from which
//! it goes on are certified. The answer will most often need them.

use crate::sequence::joining::Tried;
use crate::sequence::leaf_graph::LeafGraph;
use bevy_ecs::prelude::{Res, ResMut, Resource};
use foliate_components::graph::leaf::{LeafId, LeafIndex};
use foliate_components::roadmap::TreeId;
use foliate_systems::exploration::edges::{Connection, Connections};
use foliate_systems::exploration::reached_leaves::ReachedLeaves;
use foliate_systems::exploration::roadmap_query::RoadmapQuery;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::exploration::writer;
use foliate_systems::heuristic::leaf_heuristic::LeafHeuristic;
use std::collections::{BTreeMap, BTreeSet};

/// Leaves are proved once a side has come closer to the other by so many changes of grasp: two objects moved.
const CLOSER: u16 = 4;

/// What was reached is counted afresh where so many leaves are lost, and so many of those that are not.
const MANY: usize = 16;
const SHARE: usize = 16;

/// What is known of the leaves that candidates start from.
#[derive(Clone, Debug, Default, Resource)]
pub struct Foundations {
    /// By side: how far it was in the beginning, and the leaf that was proved last.
    sides: BTreeMap<TreeId, (u16, Option<LeafId>)>,
    /// Lost leaves that are not counted among what was reached, by side.
    forgotten: BTreeSet<(TreeId, LeafId)>,
}

/// Where nothing else is proposed: proposes the unvalidated edges that lead to the leaves from which the sides go on.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn propose_foundations(
    roadmap: RoadmapQuery<'_, '_>,
    heuristic: Res<'_, LeafHeuristic>,
    roots: Res<'_, Roots>,
    graph: Res<'_, LeafGraph>,
    mut foundations: ResMut<'_, Foundations>,
    mut tried: ResMut<'_, Tried>,
    mut connections: ResMut<'_, Connections>,
) {
    if !connections.0.is_empty() {
        return;
    }
    let roadmap = roadmap.view();
    for &root in roots.start.iter().chain(&roots.goals) {
        let side = roadmap.side_of(root);
        let Some((far, leaf)) = heuristic.heaviest(side) else { continue };
        let (first, proved) = foundations.sides.entry(side).or_insert((far, None));
        *first = far.max(*first);
        if *first < far + CLOSER || *proved == Some(leaf) {
            continue;
        }
        *proved = Some(leaf);
        let way = graph.cheapest_to_leaf(roadmap, root, leaf).unwrap_or_default();
        for join in way.into_iter().filter(|&join| graph.is_unvalidated(join)) {
            let (from, to) = graph.ends(join);
            connections.0.push(Connection::between(from, to));
            tried.0.push(Some(join));
        }
    }
}

/// Takes what no joins lead to any more out of what is chosen: nothing is gained there, however near it is.
pub fn forget_lost(
    roadmap: RoadmapQuery<'_, '_>,
    roots: Res<'_, Roots>,
    leaves: Res<'_, LeafIndex>,
    mut graph: ResMut<'_, LeafGraph>,
    mut foundations: ResMut<'_, Foundations>,
    mut reached: ResMut<'_, ReachedLeaves>,
    mut heuristic: ResMut<'_, LeafHeuristic>,
) {
    if !graph.take_broken() {
        return;
    }
    let roadmap = roadmap.view();
    let connected = graph.connected(roadmap, &roots);
    let is_kept = |tree: TreeId| connected[roadmap.tree(tree).at()];
    let of_nodes = |kept: bool| -> BTreeSet<(TreeId, LeafId)> {
        let nodes = roadmap.nodes().iter().filter(|row| is_kept(row.tree) == kept);
        nodes.map(|row| (roadmap.side(row.tree), row.leaf)).collect()
    };
    let kept = of_nodes(true);
    let lost = &of_nodes(false) - &kept;
    graph.lose(lost.iter().copied().collect());
    let new = &lost - &foundations.forgotten;
    if foundations.forgotten.is_subset(&lost) && new.len() <= MANY + kept.len() / SHARE {
        heuristic.lose(new, &leaves);
    } else {
        writer::visit_again(&mut reached, roadmap, &leaves, is_kept);
        heuristic.lose(BTreeSet::new(), &leaves);
        foundations.forgotten = lost;
    }
}
