//! The numbers of a roadmap, and what is derived from its entities.

use crate::graph::TransitionId;
use crate::roadmap::edge::{Motion, RoadmapEdge};
use crate::roadmap::entity_bytes::{ENTITY_BYTES, TICK_BYTES};
use crate::roadmap::ids::{EdgeId, NodeId, TreeId};
use crate::roadmap::node::RoadmapNode;

/// Numbers of nodes and edges by their ids, and two caches of their components: edges by node and trees by tree.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Resource))]
pub struct RoadmapStore {
    size: usize,
    configurations: Vec<f64>,
    motions: Vec<Motion>,
    /// Numbers in the knots of all motions.
    knot_numbers: usize,
    pub(crate) edges_at: EdgesAtNodes,
    pub(crate) trees: JoinedTrees,
}

impl RoadmapStore {
    /// An empty roadmap of configurations with `size` numbers.
    #[must_use]
    pub fn new(size: usize) -> Self {
        Self { size, ..Self::default() }
    }

    /// Length of a configuration.
    #[must_use]
    pub fn configuration_size(&self) -> usize {
        self.size
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.edges_at.of.len()
    }

    /// Number of validated edges.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.edges_at.next.len()
    }

    /// The id of a tree that the next node can be the root of.
    #[must_use]
    pub fn next_tree(&self) -> TreeId {
        TreeId(self.trees.joined.len() as u32)
    }

    /// The search side of a tree as born.
    #[must_use]
    pub fn side_of_tree(&self, tree: TreeId) -> TreeId {
        self.trees.sides[tree.at()]
    }

    /// Takes in the configuration of a node that is about to be spawned; returns the node's id.
    ///
    /// # Panics
    /// If the configuration has the wrong length, or the tree is neither known nor [`Self::next_tree`].
    pub fn push_node(&mut self, q: &[f64], node: &RoadmapNode) -> NodeId {
        assert_eq!(q.len(), self.size, "a configuration of another robot");
        self.configurations.extend_from_slice(q);
        self.trees.push_node(node);
        self.edges_at.push_node()
    }

    /// Takes in the motions of an edge that is about to be spawned between nodes of the trees `born`, and joins these.
    /// Returns the edge's id and its component.
    pub fn push_edge(
        &mut self,
        (from, to): (NodeId, NodeId),
        born: (TreeId, TreeId),
        along: TransitionId,
        motions: Vec<Motion>,
    ) -> (EdgeId, RoadmapEdge) {
        let (first_motion, count) = (self.motions.len() as u32, motions.len() as u32);
        self.knot_numbers += motions.iter().map(|motion| motion.knots.len()).sum::<usize>();
        self.motions.extend(motions);
        let edge = RoadmapEdge { from, to, along, first_motion, motions: count };
        self.trees.join(born.0, born.1);
        (self.edges_at.push_edge(&edge), edge)
    }

    /// A node's configuration.
    #[must_use]
    pub fn configuration(&self, node: NodeId) -> &[f64] {
        &self.configurations[node.at() * self.size..][..self.size]
    }

    /// All configurations, end to end.
    #[must_use]
    pub fn configurations(&self) -> &[f64] {
        &self.configurations
    }

    /// All motions, by row.
    #[must_use]
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// About how much memory the roadmap takes, bytes: knots and configurations, caches, and the entities of nodes and edges.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let numbers = self.configurations.len() + self.knot_numbers;
        let motions = self.motions.len() * size_of::<Motion>();
        let rows = self.nodes() * Self::NODE_BYTES + self.edges() * Self::EDGE_BYTES;
        (numbers * size_of::<f64>() + rows + motions) as u64
    }

    /// What a node takes beside its configuration, bytes: its entity with its component, its list of edges, its place on its
    /// leaf (`systems/tests/nodes_are_small.rs` measures what it really is).
    pub const NODE_BYTES: usize =
        ENTITY_BYTES + size_of::<RoadmapNode>() + TICK_BYTES + size_of::<EdgeList>() + size_of::<NodeId>();

    /// The same of an edge, beside its motions.
    pub const EDGE_BYTES: usize = ENTITY_BYTES + size_of::<RoadmapEdge>() + TICK_BYTES + size_of::<[EdgeEnd; 2]>();
}

/// An end of an edge, `2 · edge + end`, or [`EdgeEnd::NONE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct EdgeEnd(u32);

impl EdgeEnd {
    const NONE: Self = Self(u32::MAX);

    fn edge(self) -> Option<EdgeId> {
        (self != Self::NONE).then_some(EdgeId(self.0 / 2))
    }
}

/// First and last of a node's edge ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct EdgeList {
    first: EdgeEnd,
    last: EdgeEnd,
}

/// Cache of [`RoadmapEdge::from`] and [`RoadmapEdge::to`]: the edges of each node. They are lists, because most nodes have two
/// or three edges; a vector each would cost more than all else that a node has.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct EdgesAtNodes {
    /// By node: its edges, a list through `next`.
    of: Vec<EdgeList>,
    /// By edge and end: the next edge of the node there, and its end.
    next: Vec<[EdgeEnd; 2]>,
}

impl EdgesAtNodes {
    /// The same from the components.
    pub fn rebuilt(nodes: &[RoadmapNode], edges: &[RoadmapEdge]) -> Self {
        let mut new = Self::default();
        for _ in nodes {
            new.push_node();
        }
        for edge in edges {
            new.push_edge(edge);
        }
        new
    }

    fn push_node(&mut self) -> NodeId {
        self.of.push(EdgeList { first: EdgeEnd::NONE, last: EdgeEnd::NONE });
        NodeId(self.of.len() as u32 - 1)
    }

    fn push_edge(&mut self, edge: &RoadmapEdge) -> EdgeId {
        let id = EdgeId(self.next.len() as u32);
        self.next.push([EdgeEnd::NONE; 2]);
        self.append(edge.from, EdgeEnd(2 * id.0));
        self.append(edge.to, EdgeEnd(2 * id.0 + 1));
        id
    }

    fn append(&mut self, node: NodeId, end: EdgeEnd) {
        let list = &mut self.of[node.at()];
        let last = std::mem::replace(&mut list.last, end);
        match last.edge() {
            Some(edge) => self.next[edge.at()][(last.0 % 2) as usize] = end,
            None => list.first = end,
        }
    }

    /// Edges at a node, in the order in which they were validated.
    pub fn at(&self, node: NodeId) -> impl Iterator<Item = EdgeId> + '_ {
        let mut at = self.of[node.at()].first;
        std::iter::from_fn(move || {
            let edge = at.edge()?;
            at = self.next[edge.at()][(at.0 % 2) as usize];
            Some(edge)
        })
    }
}

/// Cache of which trees are joined by validated edges, and of the search side of the nodes of each tree.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct JoinedTrees {
    /// Union-find over trees as born; the smaller id is the root, so that it does not depend on the order of joins.
    pub joined: Vec<TreeId>,
    /// By tree as born: [`RoadmapNode::side`] of its nodes.
    pub sides: Vec<TreeId>,
}

impl JoinedTrees {
    fn push_node(&mut self, node: &RoadmapNode) {
        if node.tree.at() == self.joined.len() {
            self.joined.push(node.tree);
            self.sides.push(node.side);
        }
        debug_assert_eq!(self.sides[node.tree.at()], node.side, "all nodes of a tree are on one side");
    }

    fn join(&mut self, a: TreeId, b: TreeId) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.joined[a.max(b).at()] = a.min(b);
        }
    }

    /// The tree that a tree as born belongs to by now.
    pub fn root(&self, mut tree: TreeId) -> TreeId {
        while self.joined[tree.at()] != tree {
            tree = self.joined[tree.at()];
        }
        tree
    }

    /// The same from the components.
    pub fn rebuilt(nodes: &[RoadmapNode], edges: &[RoadmapEdge]) -> Self {
        let mut new = Self::default();
        nodes.iter().for_each(|node| new.push_node(node));
        edges.iter().for_each(|edge| new.join(nodes[edge.from.at()].tree, nodes[edge.to.at()].tree));
        new
    }
}
