//! The roadmap as systems read it.

use crate::graph::leaf::LeafId;
use crate::roadmap::edge::{Motion, RoadmapEdge};
use crate::roadmap::ids::{EdgeId, NodeId, TreeId};
use crate::roadmap::leaf::RoadmapLeaf;
use crate::roadmap::node::RoadmapNode;
use crate::roadmap::store::{EdgesAtNodes, JoinedTrees, RoadmapStore};

/// The components of all nodes, edges and leaves, by id, together with the numbers of the store. A view: copying it copies four
/// references.
#[derive(Clone, Copy, Debug)]
pub struct Roadmap<'w> {
    store: &'w RoadmapStore,
    nodes: &'w [RoadmapNode],
    edges: &'w [RoadmapEdge],
    leaves: &'w [RoadmapLeaf],
}

impl<'w> Roadmap<'w> {
    /// A view of these components, each in order of id.
    ///
    /// # Panics
    /// If there are other nodes or edges than the store has numbers for.
    #[must_use]
    pub fn new(
        store: &'w RoadmapStore,
        nodes: &'w [RoadmapNode],
        edges: &'w [RoadmapEdge],
        leaves: &'w [RoadmapLeaf],
    ) -> Self {
        let expected = (store.nodes(), store.edges());
        assert_eq!(
            (nodes.len(), edges.len()),
            expected,
            "the entities of nodes and edges are those that the store knows"
        );
        Self { store, nodes, edges, leaves }
    }

    /// Length of a configuration.
    #[must_use]
    pub fn configuration_size(&self) -> usize {
        self.store.configuration_size()
    }

    /// All nodes, by id.
    #[must_use]
    pub fn nodes(&self) -> &'w [RoadmapNode] {
        self.nodes
    }

    /// A node.
    #[must_use]
    pub fn node(&self, id: NodeId) -> &'w RoadmapNode {
        &self.nodes[id.at()]
    }

    /// A node's configuration.
    #[must_use]
    pub fn configuration(&self, node: NodeId) -> &'w [f64] {
        self.store.configuration(node)
    }

    /// All validated edges, by id.
    #[must_use]
    pub fn edges(&self) -> &'w [RoadmapEdge] {
        self.edges
    }

    /// A validated edge.
    #[must_use]
    pub fn edge(&self, id: EdgeId) -> &'w RoadmapEdge {
        &self.edges[id.at()]
    }

    /// The motions of an edge, in the direction in which it was found.
    #[must_use]
    pub fn motions_of(&self, edge: EdgeId) -> &'w [Motion] {
        let edge = self.edge(edge);
        &self.store.motions()[edge.first_motion as usize..][..edge.motions as usize]
    }

    /// Validated edges at a node, in the order in which they were found.
    pub fn edges_at(&self, node: NodeId) -> impl Iterator<Item = EdgeId> + 'w {
        self.store.edges_at.at(node)
    }

    /// Nodes on a leaf, by id.
    #[must_use]
    pub fn nodes_on(&self, leaf: LeafId) -> &'w [NodeId] {
        self.leaves.get(leaf.at()).map_or(&[], |leaf| leaf.nodes.as_slice())
    }

    /// The leaves that trees have reached, by id.
    #[must_use]
    pub fn leaves(&self) -> &'w [RoadmapLeaf] {
        self.leaves
    }

    /// The tree that a tree as born belongs to by now.
    #[must_use]
    pub fn tree(&self, born: TreeId) -> TreeId {
        self.store.trees.root(born)
    }

    /// The tree that a node belongs to by now.
    #[must_use]
    pub fn tree_of(&self, node: NodeId) -> TreeId {
        self.tree(self.node(node).tree)
    }

    /// Number of trees that were ever born; joined ones included.
    #[must_use]
    pub fn tree_count(&self) -> usize {
        self.store.trees.joined.len()
    }

    /// The tree on whose behalf a tree as born grows, as it is by now.
    #[must_use]
    pub fn side(&self, born: TreeId) -> TreeId {
        self.tree(self.store.side_of_tree(born))
    }

    /// The search side of a node, as it is by now.
    #[must_use]
    pub fn side_of(&self, node: NodeId) -> TreeId {
        self.tree(self.node(node).side)
    }

    /// The trees that belong to no other by now and grow for no other, by id.
    pub fn sides(self) -> impl Iterator<Item = TreeId> + 'w {
        (0..self.tree_count() as u32).map(TreeId).filter(move |&tree| self.side(tree) == tree)
    }

    /// Whether the caches of the store are what the components say, and the leaves have the nodes that say so.
    #[must_use]
    pub fn caches_are_true(&self) -> bool {
        let on_leaf = |(leaf, row): (usize, &RoadmapLeaf)| {
            let nodes = self.nodes.iter().enumerate().filter(|(_, node)| node.leaf.at() == leaf);
            let (ids, states): (Vec<_>, Vec<_>) = nodes.map(|(id, node)| (NodeId(id as u32), node.state)).unzip();
            ids == row.nodes && states.iter().all(|&state| state == row.state)
        };
        self.store.edges_at == EdgesAtNodes::rebuilt(self.nodes, self.edges)
            && self.store.trees == JoinedTrees::rebuilt(self.nodes, self.edges)
            && self.leaves.iter().enumerate().all(on_leaf)
    }

    /// A hash of everything in order of id: configurations, states, leaves, edges, knots. Equal hashes for different
    /// thread counts are the promise of determinism.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let mut hash = Fnv::default();
        self.store.configurations().iter().for_each(|x| hash.add(x.to_bits()));
        for node in self.nodes {
            hash.add(u64::from(node.state.0));
            hash.add(u64::from(node.leaf.0));
            hash.add(u64::from(node.tree.0));
        }
        for edge in self.edges {
            hash.add(u64::from(edge.from.0) << 32 | u64::from(edge.to.0));
            hash.add(u64::from(edge.along.0) << 32 | u64::from(edge.motions));
        }
        for motion in self.store.motions() {
            hash.add(u64::from(motion.leaf.0));
            motion.knots.iter().for_each(|x| hash.add(x.to_bits()));
        }
        self.store.trees.joined.iter().for_each(|tree| hash.add(u64::from(tree.0)));
        hash.0
    }
}

/// FNV-1a over 64-bit words: stable between runs and releases, unlike the standard library's hasher.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}
