//! Proposed connections and their verdicts, and the edges that are not validated yet.
//!
//! Nearly all of these turn out to be free once their waypoints are, and few are ever needed. So both their ends are roots of
//! trees of their own; a scheduler proposes the edges that it needs as connections, and only a certified one joins its trees.

use bevy_ecs::prelude::{Entity, Query, Res, Resource, World};
use bevy_ecs::system::SystemParam;
use foliate_components::roadmap::{Motion, NodeId, UnvalidatedEdge};
use foliate_components::robot::ShapeIndex;
use std::collections::BTreeMap;

/// A motion that would join two trees.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// A new node, or the one that an unvalidated edge leads from.
    pub from: NodeId,
    /// A node in another tree: on the same leaf, or the one that the unvalidated edge leads to.
    pub to: NodeId,
    /// What became of it, once that is known.
    pub verdict: Option<Verdict>,
}

/// The certified motions of a connection, end to end, or what is in the way.
pub type Verdict = Result<Vec<Motion>, Obstacle>;

/// Why two nodes are not joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Obstacle {
    /// Number of the leg that is not free.
    pub leg: u32,
    /// The pair of shapes that stopped it, where one did.
    pub blocked_by: Option<(ShapeIndex, ShapeIndex)>,
}

impl Connection {
    /// A proposal.
    #[must_use]
    pub fn between(from: NodeId, to: NodeId) -> Self {
        Self { from, to, verdict: None }
    }

    /// Whether it is certified.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        matches!(self.verdict, Some(Ok(_)))
    }
}

/// The connections of this step, in order of proposal.
#[derive(Clone, Debug, Default, Resource)]
pub struct Connections(pub Vec<Connection>);

/// The edges that are not validated yet, for a system that reads them.
#[derive(SystemParam)]
pub struct UnvalidatedEdges<'w, 's> {
    edges: Query<'w, 's, &'static UnvalidatedEdge>,
    by_end: Res<'w, UnvalidatedByEnd>,
}

impl UnvalidatedEdges<'_, '_> {
    /// The unvalidated edge that leads to a node.
    #[must_use]
    pub fn to(&self, node: NodeId) -> Option<&UnvalidatedEdge> {
        self.edges.get(self.by_end.to(node)?).ok()
    }

    /// The unvalidated edge from one node to another.
    #[must_use]
    pub fn between(&self, from: NodeId, to: NodeId) -> Option<&UnvalidatedEdge> {
        self.to(to).filter(|edge| edge.from == from)
    }

    /// About how much memory they take, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.by_end.bytes
    }
}

/// Cache of [`UnvalidatedEdge::to`]: the entities of unvalidated edges by the node that they lead to.
#[derive(Clone, Debug, Default, PartialEq, Eq, Resource)]
pub struct UnvalidatedByEnd {
    entities: BTreeMap<NodeId, Entity>,
    bytes: u64,
}

impl UnvalidatedByEnd {
    /// The entity of the unvalidated edge that leads to a node.
    #[must_use]
    pub fn to(&self, node: NodeId) -> Option<Entity> {
        self.entities.get(&node).copied()
    }

    /// Number of unvalidated edges.
    #[must_use]
    pub fn len(&self) -> usize {
        self.entities.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entities.is_empty()
    }

    /// About how much memory the edges take, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Adds an edge that has been spawned.
    pub(crate) fn add(&mut self, to: NodeId, bytes: u64, entity: Entity) {
        self.bytes += bytes;
        self.entities.insert(to, entity);
    }

    /// Takes out an edge that is validated or despawned.
    pub(crate) fn remove(&mut self, edge: &UnvalidatedEdge) {
        self.bytes -= edge.bytes();
        self.entities.remove(&edge.to);
    }

    /// The same from the components.
    #[must_use]
    pub fn rebuilt(world: &mut World) -> Self {
        let mut new = Self::default();
        let mut edges = world.query::<(Entity, &UnvalidatedEdge)>();
        edges.iter(world).for_each(|(entity, edge)| new.add(edge.to, edge.bytes(), entity));
        new
    }
}
