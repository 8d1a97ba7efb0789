//! What a search did.

use crate::view::document::Offset;
use serde::Serialize;

/// A recorded search: its roadmap and its funnel.
#[derive(Clone, Debug, Serialize)]
pub struct SearchEntry {
    /// `count` configurations: 32-bit floating-point numbers.
    pub nodes: Offset,
    /// How many nodes.
    pub count: usize,
    /// By node its tree: 16-bit.
    pub tree: Offset,
    /// By node the place of its state in the graph's list, 65535 where that is not shown: 16-bit.
    pub state: Offset,
    /// By node the step in which it came: 32-bit.
    pub step: Offset,
    /// `edge_count` pairs of nodes: 32-bit.
    pub edges: Offset,
    /// By edge the step in which it was certified: 32-bit.
    pub edge_step: Offset,
    /// How many edges; all of them are certified.
    pub edge_count: usize,
    /// What the trees are called.
    pub trees: Vec<String>,
    /// `solved`, `timeout`, …
    pub outcome: String,
    /// How it ended, in plain words.
    pub words: Vec<String>,
    /// What became of candidates, by transition.
    pub funnel: Vec<FunnelEntry>,
}

/// What became of the candidates of a transition.
#[derive(Clone, Debug, Serialize)]
pub struct FunnelEntry {
    /// Place of the transition in the graph's list.
    pub transition: Option<usize>,
    /// In plain words.
    pub words: String,
    /// Candidates.
    pub tried: u64,
    /// Of them projected.
    pub projected: u64,
    /// Of these free.
    pub free: u64,
    /// Of these at their target.
    pub reached: u64,
    /// Pairs that collided.
    pub pairs: Vec<FunnelPairEntry>,
}

/// Two links that collided.
#[derive(Clone, Debug, Serialize)]
pub struct FunnelPairEntry {
    /// The links.
    pub links: [usize; 2],
    /// How often.
    pub count: u64,
    /// Where they once did.
    pub configuration: Option<Vec<f64>>,
}
