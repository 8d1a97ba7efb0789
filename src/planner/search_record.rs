//! What is kept of a search that was asked to be recorded: its roadmap with the step of each node and edge, and its statistics.
//!
//! The entities of the roadmap are the source; what they do not keep comes from the search's log
//! ([`SearchLog`]). Of a roadmap that is too large the first nodes are kept, with the edges between them.

use bevy_ecs::prelude::World;
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::{StateStatistics, TransitionStatistics};
use foliate_components::roadmap::{EdgeId, NodeId, Roadmap, UnvalidatedEdge};
use foliate_systems::exploration::roadmap_query::roadmap_in;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::exploration::search_log::{BlockedPair, SearchLog};
use foliate_systems::search::Search;
use std::collections::BTreeMap;

/// Size of a recording where the host names none, bytes: 16 MiB.
pub const DEFAULT_RECORDING_BYTES: u64 = 16 << 20;

/// Bytes of a node in a recording, beside its configuration.
pub(crate) const NODE_BYTES: u64 = 20;
/// Bytes of an edge.
pub(crate) const EDGE_BYTES: u64 = 17;

/// Nodes of a roadmap, in the order in which they came: columns of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedNodes {
    /// Configurations, end to end.
    pub configurations: Vec<f32>,
    /// The state of each: its id in the constraint graph; in a file its place in the list of states, `u32::MAX` where that is left out.
    pub states: Vec<u32>,
    /// The leaf of each. Nodes of one leaf have one number.
    pub leaves: Vec<u32>,
    /// The tree in which each was born.
    pub trees: Vec<u32>,
    /// The search side of each: the tree, as born, of the start or of the first goal.
    pub sides: Vec<u32>,
    /// The step in which each came: 0 for roots that were there before the first step.
    pub steps: Vec<u32>,
}

/// Whether a motion is certified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeKind {
    /// Its motions are certified.
    Certified,
    /// Its waypoints are free; nothing is known between them.
    NotValidated,
    /// It was not validated, and then found not to be free.
    Refused,
}

/// Edges of a roadmap: those that are certified in the order in which they were, then those that are not validated, then those that
/// were refused. Columns of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedEdges {
    /// The node where the motions of each start.
    pub from: Vec<u32>,
    /// The node where they end.
    pub to: Vec<u32>,
    /// The transition of each: its id in the constraint graph; in a file its place in the list of transitions, `u32::MAX` where that is
    /// left out.
    pub transitions: Vec<u32>,
    /// The step in which each was certified, refused, or, while it is not validated, came.
    pub steps: Vec<u32>,
    /// What is known of each.
    pub kinds: Vec<EdgeKind>,
}

/// What is kept of a search: [`Planner::record`](crate::Planner::record) asks for it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SearchRecord {
    /// How large a file of it may be, bytes.
    pub most_bytes: u64,
    /// Numbers of a configuration.
    pub width: usize,
    /// Nodes.
    pub nodes: RecordedNodes,
    /// Edges between them.
    pub edges: RecordedEdges,
    /// The root of the start's tree.
    pub start: Option<u32>,
    /// The roots of the goals' trees.
    pub goals: Vec<u32>,
    /// Trees that were ever born.
    pub trees: usize,
    /// What became of the candidates, by transition; all that were tried.
    pub funnel: Vec<(TransitionId, TransitionStatistics)>,
    /// What there is of each state; all that have something.
    pub states: Vec<(StateId, StateStatistics)>,
    /// For pairs of shapes that stopped candidates of a transition: a configuration at which they were found too close.
    pub collisions: BTreeMap<BlockedPair, Vec<f32>>,
    /// Nodes of the roadmap that are left out.
    pub nodes_left_out: u64,
    /// Edges that are left out.
    pub edges_left_out: u64,
}

impl RecordedNodes {
    /// How many.
    #[must_use]
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// The configuration of a node.
    ///
    /// # Panics
    /// If there is no such node.
    #[must_use]
    pub fn configuration(&self, node: usize) -> &[f32] {
        let width = self.configurations.len() / self.len().max(1);
        &self.configurations[node * width..][..width]
    }

    fn truncate(&mut self, count: usize) {
        let width = self.configurations.len() / self.len().max(1);
        self.configurations.truncate(count * width);
        for column in [&mut self.states, &mut self.leaves, &mut self.trees, &mut self.sides, &mut self.steps] {
            column.truncate(count);
        }
    }
}

impl RecordedEdges {
    /// How many.
    #[must_use]
    pub fn len(&self) -> usize {
        self.from.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.from.is_empty()
    }

    fn push(&mut self, (from, to): (NodeId, NodeId), along: TransitionId, step: u64, kind: EdgeKind) {
        self.from.push(from.0);
        self.to.push(to.0);
        self.transitions.push(along.0);
        self.steps.push(narrow(step));
        self.kinds.push(kind);
    }

    fn keep_between_first(&mut self, nodes: usize) {
        let kept: Vec<bool> =
            self.from.iter().zip(&self.to).map(|(&from, &to)| (from.max(to) as usize) < nodes).collect();
        fn keep<T>(column: &mut Vec<T>, kept: &[bool]) {
            let mut flags = kept.iter();
            column.retain(|_| flags.next().copied().unwrap_or(false));
        }
        for column in [&mut self.from, &mut self.to, &mut self.transitions, &mut self.steps] {
            keep(column, &kept);
        }
        keep(&mut self.kinds, &kept);
    }
}

impl SearchRecord {
    /// What a search has done so far, for a file of at most so many bytes. Steps and places of collisions are known where the settings of
    /// the search asked for a log ([`SearchSettings::log`](foliate_systems::settings::SearchSettings::log)).
    #[must_use]
    pub fn of(search: &mut Search, most_bytes: u64) -> Self {
        let funnel = search.statistics().into_iter().filter(|(_, s)| s.attempts > 0).collect();
        let states = search.states().into_iter().filter(|(_, s)| *s != StateStatistics::default()).collect();
        let not_validated = not_validated(search.world_mut());
        let world = search.world();
        let (roadmap, roots) = (roadmap_in(world), world.resource::<Roots>());
        let nothing = SearchLog::default();
        let log = world.get_resource::<SearchLog>().unwrap_or(&nothing);
        let width = roadmap.configuration_size();
        let edges = edges(roadmap, log, &not_validated);
        let count = first_that_fit(most_bytes, width, roadmap.nodes().len(), &edges);
        let narrow_row = |q: &[f64]| q.iter().map(|&x| x as f32).collect();
        let collisions = log.collisions().iter().map(|(&pair, q)| (pair, narrow_row(q))).collect();
        let mut record = Self {
            most_bytes,
            width,
            nodes: nodes(roadmap, log, count),
            edges,
            start: roots.start.map(|root| root.0),
            goals: roots.goals.iter().map(|root| root.0).collect(),
            trees: roadmap.tree_count(),
            funnel,
            states,
            collisions,
            nodes_left_out: (roadmap.nodes().len() - count) as u64,
            edges_left_out: log.refused_left_out,
        };
        record.keep_edges(count);
        record
    }

    /// Keeps the first nodes, as many as fit into so many bytes together with the edges between them.
    pub fn fit(&mut self, bytes: u64) {
        let count = first_that_fit(bytes, self.width, self.nodes.len(), &self.edges);
        self.nodes_left_out += (self.nodes.len() - count) as u64;
        self.nodes.truncate(count);
        self.keep_edges(count);
    }

    fn keep_edges(&mut self, nodes: usize) {
        let before = self.edges.len();
        self.edges.keep_between_first(nodes);
        self.edges_left_out += (before - self.edges.len()) as u64;
        self.start = self.start.filter(|&root| (root as usize) < nodes);
        self.goals.retain(|&root| (root as usize) < nodes);
    }
}

fn narrow(step: u64) -> u32 {
    u32::try_from(step).unwrap_or(u32::MAX)
}

/// The edges that are not validated, in the order of the nodes that they lead to.
fn not_validated(world: &mut World) -> Vec<(NodeId, NodeId, TransitionId)> {
    let mut query = world.query::<&UnvalidatedEdge>();
    let mut all: Vec<_> = query.iter(world).map(|edge| (edge.from, edge.to, edge.transition)).collect();
    all.sort_unstable_by_key(|&(_, to, _)| to);
    all
}

fn nodes(roadmap: Roadmap<'_>, log: &SearchLog, count: usize) -> RecordedNodes {
    let rows = &roadmap.nodes()[..count];
    let configurations = (0..count as u32).flat_map(|node| roadmap.configuration(NodeId(node)));
    RecordedNodes {
        configurations: configurations.map(|&x| x as f32).collect(),
        states: rows.iter().map(|row| row.state.0).collect(),
        leaves: rows.iter().map(|row| row.leaf.0).collect(),
        trees: rows.iter().map(|row| row.tree.0).collect(),
        sides: rows.iter().map(|row| row.side.0).collect(),
        steps: (0..count as u32).map(|node| narrow(log.step_of_node(NodeId(node)))).collect(),
    }
}

fn edges(roadmap: Roadmap<'_>, log: &SearchLog, not_validated: &[(NodeId, NodeId, TransitionId)]) -> RecordedEdges {
    let mut edges = RecordedEdges::default();
    for (id, row) in (0u32..).map(EdgeId).zip(roadmap.edges()) {
        edges.push((row.from, row.to), row.along, log.step_of_edge(id), EdgeKind::Certified);
    }
    for &(from, to, along) in not_validated {
        edges.push((from, to), along, log.step_of_node(to), EdgeKind::NotValidated);
    }
    for edge in log.refused() {
        edges.push((edge.from, edge.to), edge.along, edge.step, EdgeKind::Refused);
    }
    edges
}

/// How many of the first nodes fit into so many bytes together with the edges between them.
fn first_that_fit(bytes: u64, width: usize, nodes: usize, edges: &RecordedEdges) -> usize {
    // By node: edges whose later end it is.
    let mut ends = vec![0_u64; nodes];
    for (&from, &to) in edges.from.iter().zip(&edges.to) {
        ends[from.max(to) as usize] += 1;
    }
    let per_node = NODE_BYTES + 4 * width as u64;
    let mut taken = 0_u64;
    let takes = |edges: &u64| {
        taken += per_node + EDGE_BYTES * edges;
        taken > bytes
    };
    ends.iter().position(takes).unwrap_or(nodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(nodes: usize, edges: &[(u32, u32)]) -> SearchRecord {
        let column = || (0..nodes as u32).collect::<Vec<u32>>();
        let mut of_edges = RecordedEdges::default();
        for &(from, to) in edges {
            of_edges.push((NodeId(from), NodeId(to)), TransitionId(0), 1, EdgeKind::Certified);
        }
        SearchRecord {
            most_bytes: 0,
            width: 2,
            nodes: RecordedNodes {
                configurations: vec![0.5; 2 * nodes],
                states: column(),
                leaves: column(),
                trees: column(),
                sides: column(),
                steps: column(),
            },
            edges: of_edges,
            start: Some(0),
            goals: vec![1, nodes as u32 - 1],
            trees: nodes,
            funnel: Vec::new(),
            states: Vec::new(),
            collisions: BTreeMap::new(),
            nodes_left_out: 0,
            edges_left_out: 0,
        }
    }

    #[test]
    fn the_first_nodes_are_kept_and_what_is_left_out_is_counted() {
        let edges = [(0, 1), (4, 1), (2, 1), (3, 0), (0, 2)];
        let mut whole = record(5, &edges);
        whole.fit(5 * 28 + 5 * 17);
        assert_eq!(whole, record(5, &edges));
        let mut cut = record(5, &edges);
        cut.fit(5 * 28 + 5 * 17 - 1);
        assert_eq!((cut.nodes.len(), cut.nodes_left_out), (4, 1));
        assert_eq!((cut.edges.from, cut.edges.to), (vec![0, 2, 3, 0], vec![1, 1, 0, 2]));
        assert_eq!((cut.edges_left_out, cut.start, cut.goals), (1, Some(0), vec![1]));
        assert_eq!(cut.nodes.configurations.len(), 8);
        let mut nothing = record(5, &edges);
        nothing.fit(27);
        assert_eq!((nothing.nodes.len(), nothing.edges.len(), nothing.edges_left_out), (0, 0, 5));
    }
}
