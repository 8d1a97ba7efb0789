//! Which nodes of a roadmap are connected to the start or a goal, and by which edge the way to it begins.

use foliate_components::roadmap::{EdgeId, NodeId, Roadmap};
use foliate_systems::exploration::roots::Roots;
use std::collections::VecDeque;

/// Grows with the roadmap; every node and edge is visited a bounded number of times.
#[derive(Debug, Default)]
pub(crate) struct Rooted {
    /// By node: the root it is connected to, and the first edge of the way there (none for the root itself).
    ways: Vec<Option<(NodeId, Option<EdgeId>)>>,
    roots: usize,
    edges: usize,
}

impl Rooted {
    /// Nodes that are connected to a root by now and were not before, those nearer to it first.
    pub(crate) fn grow(&mut self, roadmap: Roadmap<'_>, roots: &Roots) -> Vec<NodeId> {
        self.ways.resize(roadmap.nodes().len(), None);
        let mut attached = Vec::new();
        let all: Vec<NodeId> = roots.start.iter().chain(&roots.goals).copied().collect();
        for &root in &all[self.roots..] {
            self.attach(roadmap, root, (root, None), &mut attached);
        }
        self.roots = all.len();
        for edge in (self.edges as u32..roadmap.edges().len() as u32).map(EdgeId) {
            let row = roadmap.edge(edge);
            for (near, far) in [(row.from, row.to), (row.to, row.from)] {
                if let Some((root, _)) = self.ways[near.at()] {
                    self.attach(roadmap, far, (root, Some(edge)), &mut attached);
                }
            }
        }
        self.edges = roadmap.edges().len();
        attached
    }

    /// Connects a node to a root, and breadth first its neighbours, unless it is connected to one already.
    fn attach(
        &mut self,
        roadmap: Roadmap<'_>,
        node: NodeId,
        way: (NodeId, Option<EdgeId>),
        attached: &mut Vec<NodeId>,
    ) {
        let mut waiting = VecDeque::from([(node, way)]);
        while let Some((node, way)) = waiting.pop_front() {
            if self.ways[node.at()].is_none() {
                self.ways[node.at()] = Some(way);
                attached.push(node);
                let edges = roadmap.edges_at(node);
                waiting.extend(edges.map(|edge| (other_end(roadmap, edge, node), (way.0, Some(edge)))));
            }
        }
    }

    /// The root that a node is connected to; the node itself where there is none.
    pub(crate) fn root(&self, node: NodeId) -> NodeId {
        self.ways[node.at()].map_or(node, |(root, _)| root)
    }

    /// The edge by which the way from a node to its root begins.
    pub(crate) fn edge(&self, node: NodeId) -> Option<EdgeId> {
        self.ways[node.at()].and_then(|(_, edge)| edge)
    }
}

/// The end of an edge at which `node` does not lie.
pub(crate) fn other_end(roadmap: Roadmap<'_>, edge: EdgeId, node: NodeId) -> NodeId {
    let row = roadmap.edge(edge);
    if row.from == node { row.to } else { row.from }
}
