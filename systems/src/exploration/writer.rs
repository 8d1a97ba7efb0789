//! Additions to the roadmap: nodes, leaves and edges, with their entities and every index that depends on them.
//!
//! No other file adds to the roadmap. All functions here are serial, so ids do not depend on threads.

use crate::exploration::entities::{EntityTable, NewNodes};
use crate::exploration::explored::SearchSides;
use crate::exploration::neighbours::index::Neighbours;
use crate::exploration::reached_leaves::ReachedLeaves;
use crate::planning_model::model::PlanningModel;
use bevy_ecs::prelude::{Mut, World};
use foliate_components::candidate::Candidate;
use foliate_components::graph::leaf::{Leaf, LeafId, LeafIndex};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::{StateStatistics, TransitionStatistics};
use foliate_components::roadmap::{
    Along, Between, ComponentId, ConfigurationId, EdgeId, InComponent, InState, Motion, NodeId, OfFoliation, OnLeaf,
    Roadmap, Visits,
};

/// Makes the transitions that leave a state come into being, in the model of this search alone, and their entities.
pub(crate) fn expand(world: &mut World, state: StateId) {
    if !world.resource::<PlanningModel>().graph.is_expanded(state) {
        world.resource_mut::<PlanningModel>().expand(state);
        spawn_graph(world);
    }
}

/// Adds a root node: a start or a goal. Its parameters must be interned already.
pub fn add_root(world: &mut World, q: &[f64], leaf: Leaf) -> NodeId {
    let leaf_id = intern_leaf(world, leaf);
    let node = add_node(world, q, leaf_id, None);
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
    let component = world.resource::<Roadmap>().node(near).component;
    let leaf_here = |(leaf, motion)| Motion { leaf: intern_leaf(world, leaf), ..motion };
    let motions = motions.into_iter().map(leaf_here).collect();
    let leaf = intern_leaf(world, leaf);
    let node = add_node(world, q, leaf, Some(component));
    let (from, to) = if outwards { (near, node) } else { (node, near) };
    add_edge(world, from, to, along, motions);
    world.resource_mut::<NewNodes>().0.push(node);
    node
}

pub(crate) fn count_in(world: &mut World, state: StateId, change: impl FnOnce(&mut StateStatistics)) {
    let entity = world.resource::<EntityTable>().states[state.at()];
    if let Some(mut statistics) = world.get_mut::<StateStatistics>(entity) {
        change(&mut statistics);
    }
}

pub(crate) fn intern_leaf(world: &mut World, leaf: Leaf) -> LeafId {
    let state = leaf.state;
    let id = world.resource_mut::<LeafIndex>().intern(leaf);
    if world.resource::<EntityTable>().leaves.len() == id.at() {
        let entity = world.spawn((id, OfFoliation(state), Visits::default())).id();
        world.resource_mut::<EntityTable>().leaves.push(entity);
        count_in(world, state, |s| s.leaves += 1);
    }
    id
}

pub(crate) fn add_node(world: &mut World, q: &[f64], leaf: LeafId, component: Option<ComponentId>) -> NodeId {
    let state: StateId = world.resource::<LeafIndex>().leaf(leaf).state;
    expand(world, state);
    let mut roadmap = world.resource_mut::<Roadmap>();
    let node = roadmap.add_node(q, state, leaf, component);
    let component = roadmap.node(node).component;
    world.resource_scope(|world, mut neighbours: Mut<'_, Neighbours>| {
        neighbours.add(world.resource::<Roadmap>(), node);
    });
    let search_side = world.resource::<SearchSides>().side_root(component);
    visit(world, leaf, search_side);
    count_in(world, state, |s| s.nodes += 1);
    world.spawn((node, InState(state), OnLeaf(leaf), InComponent(component), ConfigurationId(node.0)));
    node
}

/// Remembers that a tree has reached a leaf (P0 eq. 12).
fn visit(world: &mut World, leaf: LeafId, component: ComponentId) {
    let entity = world.resource::<EntityTable>().leaves[leaf.at()];
    if let Some(mut visits) = world.get_mut::<Visits>(entity) {
        match visits.by_component.iter_mut().find(|(c, _)| *c == component) {
            Some((_, count)) => *count += 1,
            None => {
                // Most leaves are reached by one tree, few by more than two.
                visits.by_component.reserve_exact(1);
                visits.by_component.push((component, 1));
            }
        }
    }
    world.resource_scope(|world, mut reached: Mut<'_, ReachedLeaves>| {
        let tree = world.resource::<Roadmap>().component(component);
        reached.visit(component, tree, leaf, world.resource::<LeafIndex>().leaf(leaf));
    });
}

pub(crate) fn add_edge(
    world: &mut World,
    from: NodeId,
    to: NodeId,
    along: TransitionId,
    motions: Vec<Motion>,
) -> EdgeId {
    let mut roadmap = world.resource_mut::<Roadmap>();
    let (a, b) = (roadmap.component_of(from), roadmap.component_of(to));
    let edge = roadmap.add_edge(from, to, along, motions);
    let first_motion = roadmap.edge(edge).first_motion;
    if a != b {
        world.resource_mut::<ReachedLeaves>().join(a.min(b), a.max(b));
    }
    world.spawn((edge, Between { from, to }, Along(along), first_motion));
    edge
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
pub(crate) fn spawn_graph(world: &mut World) {
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
