//! The roadmap of a world: as a parameter of systems, and for functions that have the whole world.

use bevy_ecs::prelude::{Component, Query, QueryState, Res, Resource, World};
use bevy_ecs::query::QueryContiguousIter;
use bevy_ecs::system::SystemParam;
use foliate_components::graph::leaf::LeafId;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::roadmap::{NodeId, Roadmap, RoadmapEdge, RoadmapLeaf, RoadmapNode, RoadmapStore, TreeId};

/// Nodes, edges and leaves of the world, for a system that reads them.
#[derive(SystemParam)]
pub struct RoadmapQuery<'w, 's> {
    store: Res<'w, RoadmapStore>,
    nodes: Query<'w, 's, &'static RoadmapNode>,
    edges: Query<'w, 's, &'static RoadmapEdge>,
    leaves: Query<'w, 's, &'static RoadmapLeaf>,
}

impl RoadmapQuery<'_, '_> {
    /// All components, by id.
    #[must_use]
    pub fn view(&self) -> Roadmap<'_> {
        Roadmap::new(
            &self.store,
            rows(self.nodes.contiguous_iter().ok()),
            rows(self.edges.contiguous_iter().ok()),
            rows(self.leaves.contiguous_iter().ok()),
        )
    }
}

/// The rows of the one archetype that has the component; rows in other archetypes are missing in the answer.
fn rows<'w, C: Component>(tables: Option<QueryContiguousIter<'w, '_, &'static C, ()>>) -> &'w [C] {
    tables.into_iter().flatten().find(|rows| !rows.is_empty()).unwrap_or_default()
}

/// The queries of [`roadmap_in`], kept since making one takes longer than a commit of a node.
#[derive(Resource)]
pub struct RoadmapStates {
    nodes: QueryState<&'static RoadmapNode>,
    edges: QueryState<&'static RoadmapEdge>,
    leaves: QueryState<&'static RoadmapLeaf>,
}

impl RoadmapStates {
    /// Their archetypes come into being with the first entity of each kind. So that the queries know them, one of each kind
    /// is spawned and despawned here.
    fn new(world: &mut World) -> Self {
        let (node, tree, along) = (NodeId(0), TreeId(0), TransitionId(0));
        let state = StateId(0);
        let kinds = [
            world.spawn(RoadmapNode { state, leaf: LeafId(0), tree, side: tree }).id(),
            world.spawn(RoadmapEdge { from: node, to: node, along, first_motion: 0, motions: 0 }).id(),
            world.spawn(RoadmapLeaf { state, nodes: Vec::new() }).id(),
        ];
        let states = Self { nodes: world.query(), edges: world.query(), leaves: world.query() };
        for kind in kinds {
            world.despawn(kind);
        }
        states
    }
}

/// Makes a world ready for a roadmap of configurations with `size` numbers.
pub fn insert_roadmap(world: &mut World, size: usize) {
    world.insert_resource(RoadmapStore::new(size));
    let states = RoadmapStates::new(world);
    world.insert_resource(states);
}

/// The roadmap of a world, for exclusive systems and hosts.
///
/// # Panics
/// If the world has none: [`insert_roadmap`] was not called.
#[must_use]
pub fn roadmap_in(world: &World) -> Roadmap<'_> {
    let states = world.resource::<RoadmapStates>();
    Roadmap::new(
        world.resource::<RoadmapStore>(),
        rows(states.nodes.query_manual(world).contiguous_iter_inner().ok()),
        rows(states.edges.query_manual(world).contiguous_iter_inner().ok()),
        rows(states.leaves.query_manual(world).contiguous_iter_inner().ok()),
    )
}
