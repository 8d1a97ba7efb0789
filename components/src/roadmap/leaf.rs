//! The component of a leaf that a search has reached.

use crate::graph::StateId;
use crate::roadmap::ids::NodeId;

/// A leaf that trees have reached: P0's memory of reached leaves (eq. 12).
///
/// The n-th leaf that is spawned has [`LeafId`](crate::graph::leaf::LeafId) n; a query iterates in this order. Its parameters
/// are in [`LeafIndex`](crate::graph::leaf::LeafIndex), which tells equal leaves. How often a tree has reached it is the
/// number of its nodes here.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct RoadmapLeaf {
    /// State that it belongs to.
    pub state: StateId,
    /// Nodes on it, by id: those whose [`RoadmapNode::leaf`](crate::roadmap::RoadmapNode::leaf) it is.
    pub nodes: Vec<NodeId>,
}
