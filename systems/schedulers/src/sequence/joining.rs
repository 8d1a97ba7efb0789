//! Joins the trees that a sequence of transitions needs to be connected: by a straight motion first, then by what `local_plans` has planned.

use crate::sequence::lazy_extension::LazyExtensions;
use crate::sequence::leaf_graph::{Join, LeafGraph};
use crate::sequence::local_plans::{BlockedJoins, LocalPlans};
use bevy_ecs::prelude::{Res, ResMut, Resource};
use foliate_components::roadmap::{NodeId, Roadmap, TreeId};
use foliate_systems::exploration::edges::{Connection, Connections, UnvalidatedEdges};
use foliate_systems::exploration::entities::NewNodes;
use foliate_systems::exploration::roadmap_query::RoadmapQuery;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::planning_model::model::PlanningModel;

/// Straight motions that are tried in one round.
const AT_ONCE: usize = 2;

/// A node that has grown for a join is tried against so many nodes of the other side.
const NEIGHBOURS: usize = 3;

/// The joins of this round, in the order of the proposals; `None` for what was planned or grew.
#[derive(Clone, Debug, Default, Resource)]
pub struct Tried(pub(crate) Vec<Option<Join>>);

/// The nodes of a tree nearest to `q`, nearest first; ties by lowest id.
fn nearest_few(
    model: &PlanningModel,
    roadmap: Roadmap<'_>,
    q: &[f64],
    nodes: &[NodeId],
    tree: TreeId,
) -> impl Iterator<Item = NodeId> {
    let space = &model.problem.robot.space;
    let own = nodes.iter().copied().filter(|&node| roadmap.tree_of(node) == tree);
    let far = |node| space.distance(q, roadmap.configuration(node), &model.robot_weights);
    let mut near: Vec<_> = own.map(|node| (far(node), node)).collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.into_iter().take(NEIGHBOURS).map(|(_, node)| node)
}

/// Proposes what has been planned, the straight motions that the cheapest sequence needs and that have not been tried, and those between
/// what has grown by chance on the leaf of a join and the other side of it.
#[allow(clippy::too_many_arguments, reason = "a system's parameters are what it reads and writes")]
pub fn propose_joins(
    model: Res<'_, PlanningModel>,
    roadmap: RoadmapQuery<'_, '_>,
    roots: Res<'_, Roots>,
    unvalidated_edges: UnvalidatedEdges<'_, '_>,
    mut new: ResMut<'_, NewNodes>,
    mut blocked: ResMut<'_, BlockedJoins>,
    mut graph: ResMut<'_, LeafGraph>,
    mut plans: ResMut<'_, LocalPlans>,
    mut tried: ResMut<'_, Tried>,
    mut connections: ResMut<'_, Connections>,
) {
    let roadmap = roadmap.view();
    graph.grow(
        roadmap,
        |to| unvalidated_edges.to(to).map(|edge| edge.from),
        &model.problem.robot.space,
        &model.robot_weights,
    );
    connections.0.clear();
    if !graph.take_changes() && tried.0.is_empty() && plans.made.is_empty() {
        return;
    }
    tried.0.clear();
    for connection in std::mem::take(&mut plans.made) {
        connections.0.push(connection);
        tried.0.push(None);
    }
    for node in std::mem::take(&mut new.0) {
        let (leaf, tree) = (roadmap.node(node).leaf, roadmap.tree_of(node));
        for &join in blocked.0.iter().filter(|&&join| graph.leaf(join) == leaf) {
            let (a, b) = graph.ends(join);
            let (a, b) = (roadmap.tree_of(a), roadmap.tree_of(b));
            let other = if a == tree { b } else { a };
            if a == b || (a != tree && b != tree) {
                continue;
            }
            let q = roadmap.configuration(node);
            for to in nearest_few(&model, roadmap, q, roadmap.nodes_on(leaf), other) {
                connections.0.push(Connection::between(node, to));
                tried.0.push(None);
            }
        }
    }
    let (failed, untried): (Vec<_>, Vec<_>) =
        graph.cheapest(roadmap, &roots).unwrap_or_default().into_iter().partition(|&join| graph.effort(join) > 0.0);
    blocked.0 = failed;
    let (unvalidated_edges, mut long): (Vec<_>, Vec<_>) =
        untried.into_iter().partition(|&join| graph.is_unvalidated(join));
    // What is most likely to fail comes first: then the rest need not be tried. Unvalidated edges hardly ever do.
    long.sort_by(|&a, &b| graph.cost(b).total_cmp(&graph.cost(a)).then(a.cmp(&b)));
    long.truncate(AT_ONCE);
    let proposed = if long.is_empty() { unvalidated_edges } else { long };
    for join in proposed {
        let (from, to) = graph.ends(join);
        connections.0.push(Connection::between(from, to));
        tried.0.push(Some(join));
    }
}

/// Remembers which joins were free and which were not.
pub fn learn_from_joins(
    roadmap: RoadmapQuery<'_, '_>,
    unvalidated_edges: UnvalidatedEdges<'_, '_>,
    connections: Res<'_, Connections>,
    tried: Res<'_, Tried>,
    mut graph: ResMut<'_, LeafGraph>,
    mut lazy_extensions: ResMut<'_, LazyExtensions>,
) {
    let roadmap = roadmap.view();
    for (connection, join) in connections.0.iter().zip(&tried.0) {
        // One that was not tested, because another joined the same trees, says nothing about the lazy extension.
        if let Connection { from, to, verdict: Some(Err(_)) } = *connection
            && let Some(unvalidated_edge) = unvalidated_edges.between(from, to)
        {
            lazy_extensions.take_back((roadmap.node(from).leaf, unvalidated_edge.transition, unvalidated_edge.drawn));
        }
        // Likewise nothing about the join.
        if let (&Some(join), Some(_)) = (join, &connection.verdict) {
            graph.count_tried(join, connection.is_certified());
        }
    }
}
