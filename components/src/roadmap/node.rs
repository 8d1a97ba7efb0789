//! The component of a roadmap node.

use crate::graph::StateId;
use crate::graph::leaf::LeafId;
use crate::roadmap::ids::TreeId;

/// A node of the roadmap: a configuration ([`Roadmap::configuration`](crate::roadmap::Roadmap::configuration)) that is
/// free and lies on a leaf.
///
/// It never changes. The n-th node that is spawned has [`NodeId`](crate::roadmap::NodeId) n; a query iterates in this order.
/// Nodes keep their archetype: a host that knows more of a node keeps that in a resource, by id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component), component(immutable))]
pub struct RoadmapNode {
    /// State that it lies in: that of its leaf.
    pub state: StateId,
    /// Leaf that it lies on.
    pub leaf: LeafId,
    /// Tree in which it was born.
    pub tree: TreeId,
    /// Search side: the tree, as born, of the start or of the first goal, on whose behalf the node's tree grows. All goals are
    /// one side.
    pub side: TreeId,
}
