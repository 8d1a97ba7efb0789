//! Unvalidated edges: short motions between two leaves that a lazy extension has added and that are not certified yet. Connections
//! and their verdicts.
//!
//! Nearly all of them turn out to be free once their waypoints are, and few are ever needed. So commit keeps them here, beside
//! the roadmap, in which both ends stand as trees of their own; a scheduler proposes the ones it needs as connections, and
//! only what is certified then becomes an edge.

use bevy_ecs::prelude::Resource;
use foliate_components::graph::TransitionId;
use foliate_components::graph::leaf::LeafId;
use foliate_components::roadmap::{Motion, NodeId};
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

/// What would be an edge between two nodes, if it is free.
#[derive(Clone, Debug, PartialEq)]
pub struct UnvalidatedEdge {
    /// Where its motions start: the root of a tree.
    pub from: NodeId,
    /// The transition that it travels.
    pub transition: TransitionId,
    /// The leaf that it was aimed at, where the transition is crossed.
    pub drawn: Option<LeafId>,
    /// One for each leg, end to end; their clearance is not proven.
    pub motions: Vec<Motion>,
}

/// The unvalidated edges that nothing is known of, by the node that they lead to.
#[derive(Clone, Debug, Default, Resource)]
pub struct UnvalidatedEdges {
    open: BTreeMap<NodeId, UnvalidatedEdge>,
    bytes: u64,
}

impl UnvalidatedEdges {
    /// Keeps an unvalidated edge to a node that no other leads to.
    pub fn add(&mut self, to: NodeId, unvalidated_edge: UnvalidatedEdge) {
        self.bytes += bytes(&unvalidated_edge);
        if let Some(before) = self.open.insert(to, unvalidated_edge) {
            self.bytes -= bytes(&before);
        }
    }

    /// The unvalidated edge that leads to a node.
    #[must_use]
    pub fn to(&self, node: NodeId) -> Option<&UnvalidatedEdge> {
        self.open.get(&node)
    }

    /// The unvalidated edge from one node to another.
    #[must_use]
    pub fn between(&self, from: NodeId, to: NodeId) -> Option<&UnvalidatedEdge> {
        self.to(to).filter(|unvalidated_edge| unvalidated_edge.from == from)
    }

    /// Takes out the unvalidated edge from one node to another: something is known of it.
    pub fn take(&mut self, from: NodeId, to: NodeId) -> Option<UnvalidatedEdge> {
        self.between(from, to)?;
        let unvalidated_edge = self.open.remove(&to);
        self.bytes -= unvalidated_edge.as_ref().map_or(0, bytes);
        unvalidated_edge
    }

    /// Number of unvalidated edges that nothing is known of.
    #[must_use]
    pub fn len(&self) -> usize {
        self.open.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.open.is_empty()
    }

    /// About how much memory they take, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

fn bytes(unvalidated_edge: &UnvalidatedEdge) -> u64 {
    let knots = unvalidated_edge.motions.iter().map(|motion| size_of_val(&*motion.knots)).sum::<usize>();
    (size_of::<(NodeId, UnvalidatedEdge)>() + size_of_val(&*unvalidated_edge.motions) + knots) as u64
}

#[cfg(test)]
mod tests {
    use crate::exploration::edges::{UnvalidatedEdge, UnvalidatedEdges};
    use foliate_components::graph::TransitionId;
    use foliate_components::graph::leaf::LeafId;
    use foliate_components::roadmap::{Motion, NodeId};

    #[test]
    fn what_is_taken_is_forgotten_and_takes_no_memory() {
        let transition = TransitionId(3);
        let motion = |knots| Motion { transition, leg: 1, leaf: LeafId(0), knots, clearance: 0.0, residual: 0.0 };
        let motions = vec![motion(vec![0.0; 8])];
        let mut unvalidated_edges = UnvalidatedEdges::default();
        unvalidated_edges.add(NodeId(5), UnvalidatedEdge { from: NodeId(4), transition, drawn: None, motions });
        assert!(unvalidated_edges.bytes() > 64 && unvalidated_edges.len() == 1);
        assert!(unvalidated_edges.between(NodeId(4), NodeId(5)).is_some());
        assert!(unvalidated_edges.between(NodeId(5), NodeId(4)).is_none(), "it leads one way");
        assert_eq!(unvalidated_edges.take(NodeId(3), NodeId(5)), None);
        assert!(
            unvalidated_edges
                .take(NodeId(4), NodeId(5))
                .is_some_and(|unvalidated_edge| unvalidated_edge.motions.len() == 1)
        );
        assert!(
            unvalidated_edges.is_empty() && unvalidated_edges.bytes() == 0 && unvalidated_edges.to(NodeId(5)).is_none()
        );
    }
}
