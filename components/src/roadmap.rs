//! What a search has reached: nodes, edges, motions, and which of them hang together.
//!
//! Nodes and edges are entities; the bulk numbers (configurations, knots) lie in the columns of [`Roadmap`], indexed by
//! dense ids, because a random access by entity costs more than ten times a slice index. Only
//! `foliate_systems::step::commit` writes here.

use crate::graph::leaf::LeafId;
use crate::graph::{StateId, TransitionId};

macro_rules! dense_id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
        pub struct $name(pub u32);

        impl $name {
            /// The index, for slices.
            #[must_use]
            pub fn at(self) -> usize {
                self.0 as usize
            }
        }
    };
}

dense_id! {
    /// A roadmap node; also the index of its configuration.
    NodeId
}
dense_id! {
    /// A roadmap edge.
    EdgeId
}
dense_id! {
    /// The first of an edge's motions ([`Roadmap::motions_of`]).
    MotionId
}
dense_id! {
    /// A configuration in [`Roadmap::configuration`].
    ConfigurationId
}
dense_id! {
    /// A tree of the roadmap, numbered by its root. Trees that have been joined share a [`Roadmap::component`].
    ComponentId
}

/// The state that a node lies in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct InState(pub StateId);

/// The leaf that a node lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct OnLeaf(pub LeafId);

/// The tree in which a node was born.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct InComponent(pub ComponentId);

/// The nodes that an edge joins, in the direction in which it was found; it can be travelled both ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct Between {
    /// Where its motions start.
    pub from: NodeId,
    /// Where they end.
    pub to: NodeId,
}

/// The transition that an edge travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct Along(pub TransitionId);

/// The tree a leaf was reached by, and how often: P0's memory of reached leaves (eq. 12).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct Visits {
    /// Nodes on the leaf per tree, in order of first visit.
    pub by_component: Vec<(ComponentId, u32)>,
}

/// The foliation that a leaf belongs to: that of its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Component))]
pub struct OfFoliation(pub StateId);

/// A motion on one leaf: a polyline of whole configurations.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Transition and leg that it travels.
    pub transition: TransitionId,
    /// Number of the leg within the transition.
    pub leg: u32,
    /// The leaf that it stays on.
    pub leaf: LeafId,
    /// Knots, `size` numbers each, at least two.
    pub knots: Vec<f64>,
    /// Proven lower bound of the clearance beyond the margins along the motion, metres.
    pub clearance: f64,
    /// Proven upper bound of the residual of implicit rows along the motion.
    pub residual: f64,
}

/// One node's row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeRow {
    /// State.
    pub state: StateId,
    /// Leaf.
    pub leaf: LeafId,
    /// Tree in which it was born.
    pub component: ComponentId,
}

/// One edge's row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeRow {
    /// Start.
    pub from: NodeId,
    /// End.
    pub to: NodeId,
    /// What it travels.
    pub along: TransitionId,
    /// First motion.
    pub first_motion: MotionId,
    /// How many motions follow one another.
    pub motions: u32,
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
#[derive(Clone, Copy, Debug)]
struct EdgeList {
    first: EdgeEnd,
    last: EdgeEnd,
}

/// The columns of the roadmap.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "ecs", derive(bevy_ecs::prelude::Resource))]
pub struct Roadmap {
    size: usize,
    configurations: Vec<f64>,
    nodes: Vec<NodeRow>,
    edges: Vec<EdgeRow>,
    /// By node: its edges, a list through `next_edge`. Most nodes have two or three edges; a vector each would cost more
    /// than all else that a node has.
    edges_of: Vec<EdgeList>,
    /// By edge and end: the next edge of the node there, and its end.
    next_edge: Vec<[EdgeEnd; 2]>,
    motions: Vec<Motion>,
    /// Numbers in the knots of all motions.
    knot_numbers: usize,
    /// Union-find over trees; the smaller id is the root, so that it does not depend on the order of joins.
    joined: Vec<ComponentId>,
    /// Nodes of each tree by state, for selection.
    by_leaf: Vec<Vec<NodeId>>,
}

impl Roadmap {
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

    /// Adds a node to the tree `component`, or as the root of a new tree.
    ///
    /// # Panics
    /// If the configuration has the wrong length.
    pub fn add_node(&mut self, q: &[f64], state: StateId, leaf: LeafId, component: Option<ComponentId>) -> NodeId {
        assert_eq!(q.len(), self.size, "a configuration of another robot");
        let id = NodeId(self.nodes.len() as u32);
        let component = component.unwrap_or_else(|| {
            let new = ComponentId(self.joined.len() as u32);
            self.joined.push(new);
            new
        });
        self.configurations.extend_from_slice(q);
        self.nodes.push(NodeRow { state, leaf, component });
        self.edges_of.push(EdgeList { first: EdgeEnd::NONE, last: EdgeEnd::NONE });
        if self.by_leaf.len() <= leaf.at() {
            self.by_leaf.resize_with(leaf.at() + 1, Vec::new);
        }
        self.by_leaf[leaf.at()].push(id);
        id
    }

    /// Adds an edge with its motions and joins the trees of its ends.
    pub fn add_edge(&mut self, from: NodeId, to: NodeId, along: TransitionId, motions: Vec<Motion>) -> EdgeId {
        let id = EdgeId(self.edges.len() as u32);
        let first_motion = MotionId(self.motions.len() as u32);
        let count = motions.len() as u32;
        self.knot_numbers += motions.iter().map(|motion| motion.knots.len()).sum::<usize>();
        self.motions.extend(motions);
        self.edges.push(EdgeRow { from, to, along, first_motion, motions: count });
        self.next_edge.push([EdgeEnd::NONE; 2]);
        self.append(from, EdgeEnd(2 * id.0));
        self.append(to, EdgeEnd(2 * id.0 + 1));
        self.join(self.nodes[from.at()].component, self.nodes[to.at()].component);
        id
    }

    fn append(&mut self, node: NodeId, end: EdgeEnd) {
        let list = &mut self.edges_of[node.at()];
        let last = std::mem::replace(&mut list.last, end);
        match last.edge() {
            Some(edge) => self.next_edge[edge.at()][(last.0 % 2) as usize] = end,
            None => list.first = end,
        }
    }

    fn join(&mut self, a: ComponentId, b: ComponentId) {
        let (a, b) = (self.component(a), self.component(b));
        if a != b {
            self.joined[a.max(b).at()] = a.min(b);
        }
    }

    /// The tree that now contains the tree `component`.
    #[must_use]
    pub fn component(&self, mut component: ComponentId) -> ComponentId {
        while self.joined[component.at()] != component {
            component = self.joined[component.at()];
        }
        component
    }

    /// The tree that now contains a node.
    #[must_use]
    pub fn component_of(&self, node: NodeId) -> ComponentId {
        self.component(self.nodes[node.at()].component)
    }

    /// About how much memory the roadmap takes, bytes: knots and configurations, rows, and the entities of nodes and edges.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let numbers = self.configurations.len() + self.knot_numbers;
        let motions = self.motions.len() * size_of::<Motion>();
        let rows = self.nodes.len() * Self::NODE_BYTES + self.edges.len() * Self::EDGE_BYTES;
        (numbers * size_of::<f64>() + rows + motions) as u64
    }

    /// What a node takes beside its configuration, bytes: its row, its places in the lists of
    /// edges and leaves, and its entity with five components (`systems/tests/nodes_are_small.rs` measures what it really is).
    pub const NODE_BYTES: usize =
        size_of::<NodeRow>() + size_of::<EdgeList>() + size_of::<NodeId>() + Self::ENTITY_BYTES + 5 * Self::WORD_BYTES;

    /// The same of an edge, beside its motions: an entity with four components, one of them of two words.
    pub const EDGE_BYTES: usize =
        size_of::<EdgeRow>() + size_of::<[EdgeEnd; 2]>() + Self::ENTITY_BYTES + 4 * Self::WORD_BYTES + size_of::<u32>();

    /// An entity's id in its table, its entries in the lists of its archetype and of the world, and its share of what these
    /// leave unused: as measured.
    const ENTITY_BYTES: usize = 76;

    /// A component of one id, with the ticks of its addition and its last change.
    const WORD_BYTES: usize = 12;

    /// Number of trees that were ever born; joined ones included.
    #[must_use]
    pub fn trees(&self) -> usize {
        self.joined.len()
    }

    /// A node's configuration.
    #[must_use]
    pub fn configuration(&self, node: NodeId) -> &[f64] {
        &self.configurations[node.at() * self.size..][..self.size]
    }

    /// All nodes, by id.
    #[must_use]
    pub fn nodes(&self) -> &[NodeRow] {
        &self.nodes
    }

    /// A node's row.
    #[must_use]
    pub fn node(&self, id: NodeId) -> &NodeRow {
        &self.nodes[id.at()]
    }

    /// All edges, by id.
    #[must_use]
    pub fn edges(&self) -> &[EdgeRow] {
        &self.edges
    }

    /// An edge's row.
    #[must_use]
    pub fn edge(&self, id: EdgeId) -> &EdgeRow {
        &self.edges[id.at()]
    }

    /// The motions of an edge, in the direction in which it was found.
    #[must_use]
    pub fn motions_of(&self, edge: EdgeId) -> &[Motion] {
        let row = &self.edges[edge.at()];
        &self.motions[row.first_motion.at()..][..row.motions as usize]
    }

    /// Edges at a node, in the order in which they were found.
    pub fn edges_at(&self, node: NodeId) -> impl Iterator<Item = EdgeId> + '_ {
        let mut at = self.edges_of[node.at()].first;
        std::iter::from_fn(move || {
            let edge = at.edge()?;
            at = self.next_edge[edge.at()][(at.0 % 2) as usize];
            Some(edge)
        })
    }

    /// Nodes on a leaf, by id.
    #[must_use]
    pub fn nodes_on(&self, leaf: LeafId) -> &[NodeId] {
        self.by_leaf.get(leaf.at()).map_or(&[], Vec::as_slice)
    }

    /// A hash of everything in container order: configurations, states, leaves, edges, knots. Equal hashes for different
    /// thread counts are the promise of determinism.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let mut hash = Fnv::default();
        self.configurations.iter().for_each(|x| hash.add(x.to_bits()));
        for n in &self.nodes {
            hash.add(u64::from(n.state.0));
            hash.add(u64::from(n.leaf.0));
            hash.add(u64::from(n.component.0));
        }
        for e in &self.edges {
            hash.add(u64::from(e.from.0) << 32 | u64::from(e.to.0));
            hash.add(u64::from(e.along.0) << 32 | u64::from(e.motions));
        }
        for m in &self.motions {
            hash.add(u64::from(m.leaf.0));
            m.knots.iter().for_each(|x| hash.add(x.to_bits()));
        }
        self.joined.iter().for_each(|c| hash.add(u64::from(c.0)));
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
