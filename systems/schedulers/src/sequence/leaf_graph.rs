//! Which motions would join start and goal, and which of them to try first.
//!
//! Vertices are the trees of the roadmap; two trees are neighbours where both have a node on some leaf, and what it costs to
//! join them there is an estimate that rises with each failed effort; or where an unvalidated edge leads from one to the other. The
//! cheapest way from the start's tree to a goal's is the sequence of transitions to work on.

use foliate_components::graph::StateId;
use foliate_components::graph::leaf::LeafId;
use foliate_components::roadmap::{NodeId, Roadmap, TreeId};
use foliate_components::robot::configuration::ConfigurationSpace;
use foliate_systems::exploration::roots::Roots;
use std::collections::{BTreeMap, HashSet};

use bevy_ecs::prelude::Resource;

/// At an anchor on which so many joins have failed further ones are estimated to be twice as hard.
const ANCHOR_PATIENCE: f64 = 4.0;

/// An effort to grow together is estimated as so many straight motions.
const GROWTH: f64 = 2.0;

/// As if so many straight motions had been tried in every state, all of which had joined.
const PRIOR: f64 = 2.0;

/// What an unvalidated edge is estimated to cost, in motions: it is short, and nearly always free.
const UNVALIDATED_COST: f64 = 0.1;

/// A node by which its tree enters its leaf: a root, an end of a lazy extension, the end of an extension along a transition.
#[derive(Clone, Debug)]
struct Anchor {
    node: NodeId,
    leaf: LeafId,
    state: StateId,
    /// Place among the anchors of its leaf.
    place: usize,
    /// Distances to the anchors in front of it, weighted metres.
    lengths: Vec<f64>,
    /// Joins that have failed here.
    failures: u32,
    /// At most the effort of each of them.
    least_effort: f64,
    /// The anchor at the other end of an unvalidated edge.
    unvalidated_edge: Option<u32>,
}

/// Two anchors of different trees, on one leaf or with an unvalidated edge between them, by number, the smaller one first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Join(pub(crate) u32, pub(crate) u32);

/// See the module.
#[derive(Clone, Debug, Default, Resource)]
pub struct LeafGraph {
    anchors: Vec<Anchor>,
    /// By leaf: its anchors.
    by_leaf: Vec<Vec<u32>>,
    /// Nodes that have been visited.
    known: usize,
    /// Efforts that have failed, by join.
    efforts: BTreeMap<Join, f64>,
    /// By state: straight motions that were tried, and those that joined.
    straight: Vec<(f64, f64)>,
    /// Whether anything was added or has failed since that was last asked.
    has_changed: bool,
    /// Whether what is connected has to be found anew.
    has_broken: bool,
    /// Leaves that trees of a side have reached and no joins lead to any more.
    lost: HashSet<(TreeId, LeafId)>,
    /// Distances that are kept: their number grows with the square of the anchors of a leaf.
    lengths: u64,
}

impl LeafGraph {
    /// Takes in the nodes that are new in the roadmap, and the unvalidated edges that lead to them: by node, where the edge starts. `weights` are metres per unit of each
    /// velocity coordinate.
    pub fn grow(
        &mut self,
        roadmap: Roadmap<'_>,
        start_of_unvalidated: impl Fn(NodeId) -> Option<NodeId>,
        space: &ConfigurationSpace,
        weights: &[f64],
    ) {
        for (number, row) in (0u32..).zip(roadmap.nodes()).skip(self.known) {
            let node = NodeId(number);
            let first = roadmap.edges_at(node).next().map(|edge| roadmap.edge(edge));
            let origin = first.filter(|edge| edge.to == node).map(|edge| edge.from);
            // What grows within a leaf comes from an older node of that leaf.
            if origin.is_none_or(|from| roadmap.node(from).leaf != row.leaf) {
                self.add(node, row.leaf, roadmap, space, weights);
            }
            let start = start_of_unvalidated(node);
            if let Some(from) = start {
                self.lead(from, node);
            }
            if let Some(from) = start.or(origin).filter(|_| !self.lost.is_empty()) {
                // It may be found again, or grow from what is lost.
                let is_lost = |leaf: LeafId| self.lost.contains(&(roadmap.side_of(node), leaf));
                self.has_broken |= is_lost(row.leaf) != is_lost(roadmap.node(from).leaf);
            }
        }
        self.has_changed |= self.known < roadmap.nodes().len();
        self.known = roadmap.nodes().len();
    }

    /// Remembers an unvalidated edge between two anchors.
    pub(super) fn lead(&mut self, from: NodeId, to: NodeId) {
        let anchor = |node| self.anchors.binary_search_by_key(&node, |anchor| anchor.node).ok();
        if let (Some(from), Some(to)) = (anchor(from), anchor(to)) {
            self.anchors[from].unvalidated_edge = Some(to as u32);
            self.anchors[to].unvalidated_edge = Some(from as u32);
        }
    }

    /// Whether a join is an unvalidated edge.
    #[must_use]
    pub fn is_unvalidated(&self, join: Join) -> bool {
        self.anchors[join.0 as usize].unvalidated_edge == Some(join.1)
    }

    /// Whether anything was added or has failed since this was last asked, so that another sequence may be the cheapest.
    pub fn take_changes(&mut self) -> bool {
        std::mem::take(&mut self.has_changed)
    }

    fn add(&mut self, node: NodeId, leaf: LeafId, roadmap: Roadmap<'_>, space: &ConfigurationSpace, weights: &[f64]) {
        let here = self.by_leaf.get(leaf.at()).map_or(&[][..], Vec::as_slice);
        let q = roadmap.configuration(node);
        let length =
            |&other: &u32| space.distance(q, roadmap.configuration(self.anchors[other as usize].node), weights);
        let lengths = here.iter().map(length).collect();
        self.insert(node, leaf, roadmap.node(node).state, lengths);
    }

    /// Adds an anchor with its distances to those of its leaf.
    pub(super) fn insert(&mut self, node: NodeId, leaf: LeafId, state: StateId, lengths: Vec<f64>) {
        if self.by_leaf.len() <= leaf.at() {
            self.by_leaf.resize_with(leaf.at() + 1, Vec::new);
        }
        let here = &mut self.by_leaf[leaf.at()];
        if self.straight.len() <= state.at() {
            self.straight.resize(state.at() + 1, (0.0, 0.0));
        }
        self.lengths += here.len() as u64;
        self.anchors.push(Anchor {
            node,
            leaf,
            state,
            place: here.len(),
            lengths,
            failures: 0,
            least_effort: f64::INFINITY,
            unvalidated_edge: None,
        });
        here.push((self.anchors.len() - 1) as u32);
    }

    /// About how much memory it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let anchors = self.anchors.len() * (size_of::<Anchor>() + size_of::<u32>());
        // A tree keeps its entries in nodes that are two thirds full.
        let efforts = self.efforts.len() * size_of::<(Join, f64)>() * 3 / 2;
        (anchors + efforts) as u64 + self.lengths * size_of::<f64>() as u64
    }

    /// The nodes of a join.
    #[must_use]
    pub fn ends(&self, join: Join) -> (NodeId, NodeId) {
        (self.anchors[join.0 as usize].node, self.anchors[join.1 as usize].node)
    }

    /// The leaf of a join; of an unvalidated edge that from which it leads.
    #[must_use]
    pub fn leaf(&self, join: Join) -> LeafId {
        self.anchors[join.0 as usize].leaf
    }

    /// Failed efforts of a join; one is a straight motion, or work on a plan ([`crate::sequence::local_plans`]).
    #[must_use]
    pub fn effort(&self, join: Join) -> f64 {
        self.efforts.get(&join).copied().unwrap_or(0.0)
    }

    /// Remembers an effort that did not join.
    pub fn count_failure(&mut self, join: Join, effort: f64) {
        let spent = self.efforts.entry(join).or_default();
        if *spent == 0.0 {
            for anchor in [join.0, join.1] {
                let anchor = &mut self.anchors[anchor as usize];
                anchor.failures += 1;
                anchor.least_effort = anchor.least_effort.min(effort);
            }
        }
        *spent += effort;
        self.has_changed = true;
    }

    /// Remembers whether a join was free: its straight motion, or what makes it an unvalidated edge, which is none where it is not.
    pub fn count_tried(&mut self, join: Join, joined: bool) {
        if self.is_unvalidated(join) {
            for anchor in [join.0, join.1] {
                self.anchors[anchor as usize].unvalidated_edge = None;
            }
            self.has_broken |= !joined;
            self.has_changed = true;
            return;
        }
        let (tried, made) = &mut self.straight[self.anchors[join.0 as usize].state.at()];
        *tried += 1.0;
        *made += f64::from(u8::from(joined));
        if !joined {
            self.count_failure(join, 1.0);
        }
    }

    /// What a join is estimated to cost, in motions. Before anything was tried the rate at which straight motions join in its
    /// state counts, so that where hardly any does one join is planned instead of trying all others.
    #[must_use]
    pub fn cost(&self, join: Join) -> f64 {
        if self.is_unvalidated(join) {
            return UNVALIDATED_COST;
        }
        let (a, b) = (&self.anchors[join.0 as usize], &self.anchors[join.1 as usize]);
        let length = if a.place < b.place { b.lengths[a.place] } else { a.lengths[b.place] };
        let untried = a.failures == 0 || b.failures == 0;
        let effort = if untried { 0.0 } else { self.effort(join) };
        let tries = if effort > 0.0 { tries_after(effort) } else { self.tries_before(a.state) };
        (1.0 + length) * hardness(a) * hardness(b) * tries
    }

    /// How many straight motions a join of a state is estimated to take before any was tried.
    fn tries_before(&self, state: StateId) -> f64 {
        let (tried, made) = self.straight[state.at()];
        (PRIOR + tried) / (PRIOR + made)
    }

    /// No join on its leaf costs less at an anchor, whichever the other one is; times the hardness of that one, rounding apart.
    pub(super) fn least_cost(&self, anchor: u32) -> f64 {
        let here = &self.anchors[anchor as usize];
        let leads = here.unvalidated_edge.map(|other| &self.anchors[other as usize]);
        if leads.is_some_and(|other| other.leaf == here.leaf) {
            return 0.0;
        }
        hardness(here) * self.tries_before(here.state).min(tries_after(here.least_effort))
    }

    /// How hard it is to join anything to an anchor, at least 1.
    pub(super) fn hardness(&self, anchor: u32) -> f64 {
        hardness(&self.anchors[anchor as usize])
    }

    pub(super) fn leaf_of(&self, anchor: u32) -> LeafId {
        self.anchors[anchor as usize].leaf
    }

    /// The anchors of a leaf that may not be reached yet, the oldest first.
    pub(super) fn anchors_at(&self, leaf: LeafId) -> Option<&[u32]> {
        self.by_leaf.get(leaf.at()).map(Vec::as_slice)
    }

    /// The node of an anchor.
    pub(super) fn node_of(&self, anchor: u32) -> NodeId {
        self.anchors[anchor as usize].node
    }

    pub(super) fn leaf_count(&self) -> usize {
        self.by_leaf.len()
    }

    /// The anchors of a leaf, the oldest first.
    pub(super) fn anchors_on(&self, leaf: usize) -> &[u32] {
        &self.by_leaf[leaf]
    }

    /// The anchor to which an unvalidated edge leads from another one.
    pub(super) fn unvalidated_at(&self, anchor: u32) -> Option<u32> {
        self.anchors[anchor as usize].unvalidated_edge
    }

    /// By tree: whether joins lead there from the tree of a root on whose side it grows. It may be that none do: an unvalidated edge
    /// on the way was no edge.
    #[must_use]
    pub fn connected(&self, roadmap: Roadmap<'_>, roots: &Roots) -> Vec<bool> {
        let (trees, members) = self.by_tree(roadmap);
        let mut connected = vec![false; roadmap.tree_count()];
        let mut left: Vec<_> = roots.start.iter().chain(&roots.goals).map(|&root| roadmap.tree_of(root)).collect();
        left.iter().for_each(|root| connected[root.at()] = true);
        while let Some(tree) = left.pop() {
            for &anchor in &members[tree.at()] {
                let Anchor { leaf, unvalidated_edge, .. } = &self.anchors[anchor as usize];
                for &other in self.by_leaf[leaf.at()].iter().chain(unvalidated_edge) {
                    let next = trees[other as usize];
                    if !connected[next.at()] && roadmap.side(next) == roadmap.side(tree) {
                        connected[next.at()] = true;
                        left.push(next);
                    }
                }
            }
        }
        connected
    }

    /// The tree of each anchor, and the anchors of each tree.
    pub(super) fn by_tree(&self, roadmap: Roadmap<'_>) -> (Vec<TreeId>, Vec<Vec<u32>>) {
        let trees: Vec<TreeId> = self.anchors.iter().map(|anchor| roadmap.tree_of(anchor.node)).collect();
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); roadmap.tree_count()];
        (0u32..).zip(&trees).for_each(|(anchor, tree)| members[tree.at()].push(anchor));
        (trees, members)
    }

    /// Whether an unvalidated edge was none since that was last asked, so that what lies behind it may be lost.
    pub fn take_broken(&mut self) -> bool {
        std::mem::take(&mut self.has_broken)
    }

    /// Remembers which leaves no joins lead to any more, by side.
    pub fn lose(&mut self, lost: HashSet<(TreeId, LeafId)>) {
        self.lost = lost;
    }
}

fn hardness(anchor: &Anchor) -> f64 {
    1.0 + f64::from(anchor.failures) / ANCHOR_PATIENCE
}

/// How many straight motions a join is estimated to take on which an effort has been spent in vain.
fn tries_after(effort: f64) -> f64 {
    1.0 + GROWTH * effort
}
