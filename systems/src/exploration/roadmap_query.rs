//! The roadmap of a world: as a parameter of systems, and for functions that have the whole world.

use bevy_ecs::prelude::{AnyOf, Query, QueryState, Res, Resource, World};
use bevy_ecs::query::QueryContiguousIter;
use bevy_ecs::system::SystemParam;
use foliate_components::graph::leaf::LeafId;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::roadmap::{NodeId, Roadmap, RoadmapEdge, RoadmapLeaf, RoadmapNode, RoadmapStore, TreeId};

/// The components of a roadmap: each entity has one of them. One query for all of them costs a third of three, and every search
/// makes its queries anew.
type Rows = AnyOf<(&'static RoadmapNode, &'static RoadmapEdge, &'static RoadmapLeaf)>;

/// Nodes, edges and leaves of the world, for a system that reads them.
#[derive(SystemParam)]
pub struct RoadmapQuery<'w, 's> {
    store: Res<'w, RoadmapStore>,
    rows: Query<'w, 's, Rows>,
}

impl RoadmapQuery<'_, '_> {
    /// All components, by id.
    #[must_use]
    pub fn view(&self) -> Roadmap<'_> {
        view(&self.store, self.rows.contiguous_iter().ok())
    }
}

/// Each kind of entity has one archetype, so that its rows are one slice in the order in which they were spawned.
///
/// # Panics
/// If the entities of a kind are in two archetypes: then row n has not id n.
fn view<'w>(store: &'w RoadmapStore, tables: Option<QueryContiguousIter<'w, '_, Rows, ()>>) -> Roadmap<'w> {
    let (mut nodes, mut edges, mut leaves): (&[_], &[_], &[_]) = (&[], &[], &[]);
    for table in tables.into_iter().flatten() {
        match table {
            (Some(rows), _, _) if !rows.is_empty() => take(&mut nodes, rows),
            (_, Some(rows), _) if !rows.is_empty() => take(&mut edges, rows),
            (_, _, Some(rows)) if !rows.is_empty() => take(&mut leaves, rows),
            _ => {}
        }
    }
    Roadmap::new(store, nodes, edges, leaves)
}

fn take<'w, T>(kind: &mut &'w [T], rows: &'w [T]) {
    assert!(kind.is_empty(), "the entities of nodes, edges and leaves keep their archetype");
    *kind = rows;
}

/// The query of [`roadmap_in`], kept since making one takes longer than adding a node.
#[derive(Resource)]
pub struct RoadmapRows(QueryState<Rows>);

impl RoadmapRows {
    /// An archetype comes into being with the first entity of its kind. So that the query knows all of them, one entity of each
    /// kind is spawned and despawned here.
    fn new(world: &mut World) -> Self {
        let (node, tree, along) = (NodeId(0), TreeId(0), TransitionId(0));
        let state = StateId(0);
        let kinds = [
            world.spawn(RoadmapNode { state, leaf: LeafId(0), tree, side: tree }).id(),
            world.spawn(RoadmapEdge { from: node, to: node, along, first_motion: 0, motions: 0 }).id(),
            world.spawn(RoadmapLeaf { state, nodes: Vec::new() }).id(),
        ];
        let rows = world.query();
        for kind in kinds {
            world.despawn(kind);
        }
        Self(rows)
    }
}

/// Makes a world ready for a roadmap of configurations with `size` numbers.
pub fn insert_roadmap(world: &mut World, size: usize) {
    world.insert_resource(RoadmapStore::new(size));
    let rows = RoadmapRows::new(world);
    world.insert_resource(rows);
}

/// The roadmap of a world, for exclusive systems and hosts.
///
/// # Panics
/// If the world has none: [`insert_roadmap`] was not called.
#[must_use]
pub fn roadmap_in(world: &World) -> Roadmap<'_> {
    let rows = world.resource::<RoadmapRows>();
    view(world.resource::<RoadmapStore>(), rows.0.query_manual(world).contiguous_iter_inner().ok())
}
