//! Additions to the roadmap: nodes, leaves and edges, with their entities and every index that depends on them.
//!
//! No other file adds to the roadmap. All functions here are serial, so ids do not depend on threads.

use crate::exploration::edges::UnvalidatedByEnd;
use crate::exploration::entities::{EntityTable, NewNodes};
use crate::exploration::neighbours::index::Neighbours;
use crate::exploration::reached_leaves::ReachedLeaves;
use crate::exploration::roadmap_query::roadmap_in;
use crate::planning_model::model::PlanningModel;
use bevy_ecs::prelude::{Entity, Mut, World};
use foliate_components::candidate::Candidate;
use foliate_components::graph::leaf::{Leaf, LeafId, LeafIndex};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::{StateStatistics, TransitionStatistics};
use foliate_components::roadmap::{
    EdgeId, Motion, NodeId, Roadmap, RoadmapEdge, RoadmapLeaf, RoadmapNode, RoadmapStore, TreeId, UnvalidatedEdge,
};

/// Makes the transitions that leave a state come into being, in the model of this search alone, and their entities.
pub fn expand(world: &mut World, state: StateId) {
    if !world.resource::<PlanningModel>().graph.is_expanded(state) {
        world.resource_mut::<PlanningModel>().expand(state);
        spawn_graph(world);
    }
}

/// Adds a root node: a start, or a goal. All goals are one search side, that of the first of them: however many configurations
/// there are of a goal that leaves something free, the start gets half of the effort. Its parameters must be interned already.
pub fn add_root(world: &mut World, q: &[f64], leaf: Leaf, first_goal: Option<NodeId>) -> NodeId {
    let leaf_id = intern_leaf(world, leaf);
    let node = add_node(world, q, leaf_id, first_goal.map_or(Born::AsRoot, Born::OnSideOf));
    world.resource_mut::<NewNodes>().0.push(node);
    node
}

/// Adds a node that was reached in another world: from a node that is here already, along a transition (or backwards, where
/// not `outwards`), by motions that were certified there, each with the leaf that it stays on. Parameters must be interned
/// already.
pub fn add_branch(
    world: &mut World,
    (near, along, outwards): (NodeId, TransitionId, bool),
    q: &[f64],
    leaf: Leaf,
    motions: Vec<(Leaf, Motion)>,
) -> NodeId {
    let leaf_here = |(leaf, motion)| Motion { leaf: intern_leaf(world, leaf), ..motion };
    let motions = motions.into_iter().map(leaf_here).collect();
    let leaf = intern_leaf(world, leaf);
    let node = add_node(world, q, leaf, Born::InTreeOf(near));
    let (from, to) = if outwards { (near, node) } else { (node, near) };
    add_edge(world, (from, to), along, motions);
    world.resource_mut::<NewNodes>().0.push(node);
    node
}

/// Counts something of a state.
pub fn count_in(world: &mut World, state: StateId, change: impl FnOnce(&mut StateStatistics)) {
    let entity = world.resource::<EntityTable>().states[state.at()];
    if let Some(mut statistics) = world.get_mut::<StateStatistics>(entity) {
        change(&mut statistics);
    }
}

/// The id of a leaf; a leaf that is new gets an entity. Its parameters must be interned already.
pub fn intern_leaf(world: &mut World, leaf: Leaf) -> LeafId {
    let state = leaf.state;
    let id = world.resource_mut::<LeafIndex>().intern(leaf);
    if world.resource::<EntityTable>().leaves.len() == id.at() {
        let entity = world.spawn(RoadmapLeaf { state, nodes: Vec::new() }).id();
        world.resource_mut::<EntityTable>().leaves.push(entity);
        count_in(world, state, |s| s.leaves += 1);
    }
    id
}

/// Where a node is born.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Born {
    /// In the tree of another node.
    InTreeOf(NodeId),
    /// As the root of a tree that grows for itself.
    AsRoot,
    /// As the root of a tree that grows for the side of another node.
    OnSideOf(NodeId),
}

/// Adds a node on a leaf that is interned already, with its entity and in all indices.
pub fn add_node(world: &mut World, q: &[f64], leaf: LeafId, born: Born) -> NodeId {
    let state: StateId = world.resource::<LeafIndex>().leaf(leaf).state;
    expand(world, state);
    let new = world.resource::<RoadmapStore>().next_tree();
    let (tree, side) = match born {
        Born::InTreeOf(near) => {
            let near = roadmap_in(world).node(near);
            (near.tree, near.side)
        }
        Born::AsRoot => (new, new),
        Born::OnSideOf(near) => (new, roadmap_in(world).node(near).side),
    };
    let row = RoadmapNode { state, leaf, tree, side };
    let node = world.resource_mut::<RoadmapStore>().push_node(q, &row);
    world.spawn(row);
    let entity = world.resource::<EntityTable>().leaves[leaf.at()];
    if let Some(mut leaf) = world.get_mut::<RoadmapLeaf>(entity) {
        leaf.nodes.push(node);
    }
    world.resource_scope(|world, mut neighbours: Mut<'_, Neighbours>| {
        neighbours.add(roadmap_in(world), node);
    });
    // P0 eq. 12: a search side remembers how often it has reached which leaf.
    world.resource_scope(|world, mut reached: Mut<'_, ReachedLeaves>| {
        let tree = roadmap_in(world).tree(side);
        reached.visit(side, tree, leaf, world.resource::<LeafIndex>().leaf(leaf));
    });
    count_in(world, state, |s| s.nodes += 1);
    node
}

/// Adds a validated edge: its motions are certified and lead from the first node to the second, end to end. Joins the trees
/// of its ends.
pub fn add_edge(world: &mut World, (from, to): (NodeId, NodeId), along: TransitionId, motions: Vec<Motion>) -> EdgeId {
    let (id, edge) = push_edge(world, (from, to), along, motions);
    world.spawn(edge);
    id
}

/// Takes the motions of an edge into the store and joins the trees of its ends.
fn push_edge(
    world: &mut World,
    (from, to): (NodeId, NodeId),
    along: TransitionId,
    motions: Vec<Motion>,
) -> (EdgeId, RoadmapEdge) {
    let roadmap = roadmap_in(world);
    let (a, b) = (roadmap.tree_of(from), roadmap.tree_of(to));
    let born = (roadmap.node(from).tree, roadmap.node(to).tree);
    if a != b {
        world.resource_mut::<ReachedLeaves>().join(a.min(b), a.max(b));
    }
    world.resource_mut::<RoadmapStore>().push_edge((from, to), born, along, motions)
}

/// Adds an edge that is not validated yet, between the roots of two trees. No other leads to its end.
pub fn add_unvalidated_edge(world: &mut World, edge: UnvalidatedEdge) {
    let (to, bytes) = (edge.to, edge.bytes());
    let entity = world.spawn(edge).id();
    world.resource_mut::<UnvalidatedByEnd>().add(to, bytes, entity);
}

/// Counts afresh what trees have reached, by the nodes of those that are kept.
pub fn visit_again(
    reached: &mut ReachedLeaves,
    roadmap: Roadmap<'_>,
    leaves: &LeafIndex,
    is_kept: impl Fn(TreeId) -> bool,
) {
    reached.clear();
    for row in roadmap.nodes().iter().filter(|row| is_kept(row.tree)) {
        reached.visit(row.side, roadmap.tree(row.side), row.leaf, leaves.leaf(row.leaf));
    }
}

/// Takes the unvalidated edge between two nodes out of the world, if there is one: something is known of it now. Its entity is
/// left without a component.
pub fn take_unvalidated_edge(world: &mut World, (from, to): (NodeId, NodeId)) -> Option<(Entity, UnvalidatedEdge)> {
    let entity = world.resource::<UnvalidatedByEnd>().to(to)?;
    world.get::<UnvalidatedEdge>(entity).filter(|edge| edge.from == from)?;
    let edge = world.entity_mut(entity).take::<UnvalidatedEdge>()?;
    world.resource_mut::<UnvalidatedByEnd>().remove(&edge);
    Some((entity, edge))
}

/// Makes a validated edge of the entity of one that was not validated.
pub fn validate_edge(
    world: &mut World,
    entity: Entity,
    ends: (NodeId, NodeId),
    along: TransitionId,
    motions: Vec<Motion>,
) -> EdgeId {
    let (id, edge) = push_edge(world, ends, along, motions);
    world.entity_mut(entity).insert(edge);
    id
}

/// Spawns what exists before the first step: transitions with weight and statistics, states with theirs, and the pool of
/// candidates. The model must be a resource already.
pub fn spawn_graph_and_candidates(world: &mut World, candidates: usize) {
    world.init_resource::<EntityTable>();
    spawn_graph(world);
    let candidates =
        (0..candidates as u32).map(|index| world.spawn(Candidate { index, ..Candidate::default() }).id()).collect();
    world.resource_mut::<EntityTable>().candidates = candidates;
}

/// Spawns the entities of what has come into being in the graph since this was last done.
pub fn spawn_graph(world: &mut World) {
    world.resource_scope(|world, model: Mut<'_, PlanningModel>| {
        world.resource_scope(|world, mut table: Mut<'_, EntityTable>| {
            let first = table.transitions.len();
            for (id, transition) in (first as u32..).zip(&model.graph.transitions[first..]) {
                let weight = crate::exploration::entities::Weight(transition.weight);
                table.transitions.push(world.spawn((TransitionId(id), weight, TransitionStatistics::default())).id());
            }
            for id in table.states.len()..model.graph.states.len() {
                table.states.push(world.spawn((StateId(id as u32), StateStatistics::default())).id());
            }
        });
    });
}
