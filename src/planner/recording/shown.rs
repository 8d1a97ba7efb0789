//! What a page shows of a recording: nodes by the tree that they belong to in the end, joins of trees, the funnel.

use crate::planner::recording::document::{BlockedPairEntry, FunnelEntry, Recording};
use crate::planner::search_record::EdgeKind;
use std::collections::HashMap;

/// The number for a state or transition that is left out, where 16 bits number them.
const UNKNOWN: u16 = u16::MAX;

/// What a page shows of a search. Columns of nodes and edges have one row each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShownSearch {
    /// Configurations of nodes by coordinate of the path file, end to end.
    pub configurations: Vec<f32>,
    /// Names of what nodes belong to in the end: `start`, `goal 1`, …, and what is connected with none of them.
    pub trees: Vec<String>,
    /// By node its place in [`Self::trees`].
    pub tree: Vec<u16>,
    /// By node the place of its state among those of the recording; 65535 where that is left out.
    pub state: Vec<u16>,
    /// By node the step in which it came.
    pub step: Vec<u32>,
    /// Pairs of nodes; those that were certified first, then those that were not validated, then those that were refused.
    pub edges: Vec<[u32; 2]>,
    /// By edge the step in which it was certified or refused, or came.
    pub edge_step: Vec<u32>,
    /// By edge: 0 certified, 1 not validated, 2 refused.
    pub edge_kind: Vec<u8>,
    /// By edge the place of its transition; 65535 where that is left out.
    pub edge_transition: Vec<u16>,
    /// Where two trees became one, in order.
    pub joins: Vec<TreeJoin>,
    /// `solved`, `timeout`, …
    pub outcome: String,
    /// The search in sentences.
    pub words: Vec<String>,
    /// What became of candidates, by transition.
    pub funnel: Vec<ShownFunnel>,
}

/// An edge that made one tree of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeJoin {
    /// When.
    pub step: u32,
    /// The edge's number.
    pub edge: u32,
}

/// What became of the candidates of a transition.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownFunnel {
    /// Place of the transition.
    pub transition: usize,
    /// Its name, as in path files.
    pub name: String,
    /// What it does.
    pub words: String,
    /// Candidates that chose it.
    pub tried: u64,
    /// Of these: all waypoints were found.
    pub projected: u64,
    /// Of these: no waypoint collides.
    pub free: u64,
    /// Of these: reached the target.
    pub reached: u64,
    /// Pairs that stopped candidates, most frequent first.
    pub pairs: Vec<ShownPair>,
}

/// Two links that stopped candidates.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownPair {
    /// `part/link` of both.
    pub links: [String; 2],
    /// `part/shape` of both.
    pub shapes: [String; 2],
    /// How often.
    pub count: u64,
    /// A configuration at which they were found closer than they may be, by coordinate of the path file.
    pub configuration: Option<Vec<f64>>,
}

impl Recording {
    /// What a page shows of it.
    #[must_use]
    pub fn shown(&self) -> ShownSearch {
        let Self { nodes, edges, .. } = self;
        let (names, tree, joins) = self.trees();
        let still: Vec<f32> = self.head.still.iter().map(|&x| x as f32).collect();
        let row = |node| nodes.configuration(node).iter().chain(&still).copied();
        ShownSearch {
            configurations: (0..nodes.len()).flat_map(row).collect(),
            trees: names,
            tree,
            state: nodes.states.iter().map(|&state| short(state)).collect(),
            step: nodes.steps.clone(),
            edges: edges.from.iter().zip(&edges.to).map(|(&from, &to)| [from, to]).collect(),
            edge_step: edges.steps.clone(),
            edge_kind: edges.kinds.iter().map(|kind| kind.code()).collect(),
            edge_transition: edges.transitions.iter().map(|&along| short(along)).collect(),
            joins,
            outcome: self.head.outcome.clone(),
            words: self.words(),
            funnel: self.head.funnel.iter().map(|row| self.funnel_row(row)).collect(),
        }
    }

    /// Names of trees, by node the place of its own, and the joins. What an edge joins that is not certified stays apart.
    fn trees(&self) -> (Vec<String>, Vec<u16>, Vec<TreeJoin>) {
        let Self { head, nodes, edges, .. } = self;
        let mut born = HashMap::new();
        let mut union = Union::new(nodes.len());
        for (node, &tree) in nodes.trees.iter().enumerate() {
            let first = *born.entry(tree).or_insert(node);
            union.join(first, node);
        }
        let mut joins = Vec::new();
        for (edge, kind) in edges.kinds.iter().enumerate() {
            let (from, to) = (edges.from[edge] as usize, edges.to[edge] as usize);
            if *kind == EdgeKind::Certified && union.join(from, to) {
                joins.push(TreeJoin { step: edges.steps[edge], edge: edge as u32 });
            }
        }
        let mut names: Vec<String> = Vec::new();
        let mut named = HashMap::new();
        let goals = head.roots.goals.iter().enumerate().map(|(number, &root)| (format!("goal {}", number + 1), root));
        let roots = head.roots.start.map(|root| (String::from("start"), root)).into_iter().chain(goals);
        // The last place is for what is connected with none of them.
        for (name, root) in roots.take(usize::from(UNKNOWN) - 2) {
            named.entry(union.root(root as usize)).or_insert_with(|| {
                names.push(name);
                names.len() as u16 - 1
            });
        }
        let start_side = head.roots.start.and_then(|root| nodes.sides.get(root as usize));
        let apart = names.len() as u16;
        names.push("on the start's side, not connected with it".into());
        names.push("on the goals' side, not connected with one".into());
        let mut place = |node: usize| {
            let side = u16::from(start_side.is_some_and(|&start| nodes.sides[node] != start));
            named.get(&union.root(node)).copied().unwrap_or(apart + side)
        };
        let tree = (0..nodes.len()).map(&mut place).collect();
        (names, tree, joins)
    }

    fn funnel_row(&self, row: &FunnelEntry) -> ShownFunnel {
        ShownFunnel {
            transition: row.transition as usize,
            name: self.head.transitions[row.transition as usize].name.clone(),
            words: self.head.transitions[row.transition as usize].words.clone(),
            tried: row.tried,
            projected: row.projected,
            free: row.free,
            reached: row.reached,
            pairs: row.pairs.iter().map(|pair| self.pair(pair)).collect(),
        }
    }

    fn pair(&self, pair: &BlockedPairEntry) -> ShownPair {
        ShownPair {
            links: pair.links.clone(),
            shapes: pair.shapes.clone(),
            count: pair.count,
            configuration: pair.at.map(|at| self.collision(at as usize)),
        }
    }

    /// A configuration of a pair, by coordinate of the path file.
    ///
    /// # Panics
    /// If there is no such configuration.
    #[must_use]
    pub fn collision(&self, at: usize) -> Vec<f64> {
        let width = self.head.width;
        let row = self.collisions[at * width..][..width].iter().map(|&x| f64::from(x));
        row.chain(self.head.still.iter().copied()).collect()
    }
}

fn short(place: u32) -> u16 {
    u16::try_from(place).unwrap_or(UNKNOWN)
}

/// Union-find over nodes.
struct Union(Vec<usize>);

impl Union {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// Joins what two are in; whether they were apart.
    fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
        a != b
    }

    /// What one is in; halves the way there, so that no way is long for long.
    fn root(&mut self, mut at: usize) -> usize {
        while self.0[at] != at {
            self.0[at] = self.0[self.0[at]];
            at = self.0[at];
        }
        at
    }
}
