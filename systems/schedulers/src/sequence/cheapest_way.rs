//! The cheapest way from a tree to others, by joins.
//!
//! Trees are settled in the order of what it costs to reach them, as Dijkstra does it. On a leaf each anchor may be joined to each other one, so that to
//! look at all pairs takes the square of their number. An anchor is therefore left out of its leaf for good as soon as no join there
//! can make its tree cheaper to reach. The answer stays that of a search that looks at all pairs, ties included.

use crate::sequence::leaf_graph::{Join, LeafGraph};
use foliate_components::graph::leaf::LeafId;
use foliate_components::roadmap::{NodeId, Roadmap, TreeId};
use foliate_systems::exploration::roots::Roots;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A bound on a product is taken a little lower than it is: its factors may be multiplied in another order.
const ROUNDING: f64 = 1.0 - 1e-12;

impl LeafGraph {
    /// The joins on the cheapest way from the start's tree to a goal's, the start's first; `None` where there is no way yet,
    /// nothing where start and goal are connected. Ties go to the older tree.
    #[must_use]
    pub fn cheapest(&self, roadmap: Roadmap<'_>, roots: &Roots) -> Option<Vec<Join>> {
        let goals: Vec<_> = roots.goals.iter().map(|&goal| roadmap.tree_of(goal)).collect();
        self.cheapest_between(roadmap, roadmap.tree_of(roots.start?), &goals)
    }

    /// Likewise from the tree of a root to any that has reached a leaf on the root's side.
    #[must_use]
    pub fn cheapest_to_leaf(&self, roadmap: Roadmap<'_>, root: NodeId, leaf: LeafId) -> Option<Vec<Join>> {
        let here = self.anchors_at(leaf)?.iter().map(|&anchor| self.node_of(anchor));
        let own = here.filter(|&node| roadmap.side_of(node) == roadmap.side_of(root));
        let goals: Vec<_> = own.map(|node| roadmap.tree_of(node)).collect();
        self.cheapest_between(roadmap, roadmap.tree_of(root), &goals)
    }

    /// Likewise from a tree to any of some others.
    fn cheapest_between(&self, roadmap: Roadmap<'_>, start: TreeId, goals: &[TreeId]) -> Option<Vec<Join>> {
        let (trees, members) = self.by_tree(roadmap);
        cheapest_way(self, &trees, &members, start, goals)
    }
}

/// The joins on the cheapest way from one tree to any of some others, the first one's first. `trees` has the tree of each anchor, `members` the anchors of
/// each tree. Ties go to the older tree, then to the older anchor.
fn cheapest_way(
    graph: &LeafGraph,
    trees: &[TreeId],
    members: &[Vec<u32>],
    start: TreeId,
    goals: &[TreeId],
) -> Option<Vec<Join>> {
    let mut search = Search {
        graph,
        trees,
        best: vec![f64::INFINITY; members.len()],
        came_by: vec![None; members.len()],
        is_goal: vec![false; members.len()],
        limit: f64::INFINITY,
        // Costs are never negative, so their bits are in their order.
        frontier: BinaryHeap::from([Reverse((0.0f64.to_bits(), start))]),
        open: vec![None; graph.leaf_count()],
    };
    goals.iter().for_each(|goal| search.is_goal[goal.at()] = true);
    search.best[start.at()] = 0.0;
    while let Some(Reverse((bits, tree))) = search.frontier.pop() {
        let cost = f64::from_bits(bits);
        if search.is_goal[tree.at()] {
            return Some(search.way_back(tree));
        }
        if cost <= search.best[tree.at()] {
            members[tree.at()].iter().for_each(|&anchor| search.leave_by(anchor, tree, cost));
        }
    }
    None
}

struct Search<'a> {
    graph: &'a LeafGraph,
    trees: &'a [TreeId],
    /// By tree: what the cheapest way there costs that is known.
    best: Vec<f64>,
    came_by: Vec<Option<(Join, TreeId)>>,
    is_goal: Vec<bool>,
    /// What the cheapest known way to a goal costs: nothing dearer is on a cheaper one.
    limit: f64,
    frontier: BinaryHeap<Reverse<(u64, TreeId)>>,
    /// By leaf: its anchors that a join on it may still make cheaper to reach, in their order; none before the leaf is reached.
    open: Vec<Option<Vec<u32>>>,
}

impl Search<'_> {
    /// Follows all joins of an anchor of a tree that is reached at a cost.
    fn leave_by(&mut self, anchor: u32, tree: TreeId, cost: f64) {
        let leaf = self.graph.leaf_of(anchor).at();
        let hard = self.graph.hardness(anchor) * ROUNDING;
        let mut open = self.open[leaf].take().unwrap_or_else(|| self.graph.anchors_on(leaf).to_vec());
        open.retain(|&other| {
            let next = self.trees[other as usize];
            let least = self.graph.least_cost(other) * ROUNDING;
            // Later trees cost more to reach, and what is known gets cheaper: this never changes again.
            let bound = self.best[next.at()].min(self.limit);
            if bound < cost + least || self.best[next.at()] <= cost {
                return false;
            }
            if cost + least * hard <= bound {
                self.follow(anchor, other, tree, cost);
            }
            true
        });
        self.open[leaf] = Some(open);
        if let Some(other) = self.graph.unvalidated_at(anchor) {
            self.follow(anchor, other, tree, cost);
        }
    }

    /// Reaches the tree of an anchor by a join, where that is cheaper than by all others so far.
    fn follow(&mut self, anchor: u32, other: u32, tree: TreeId, cost: f64) {
        let next = self.trees[other as usize];
        if self.best[next.at()] <= cost {
            return;
        }
        let join = Join(anchor.min(other), anchor.max(other));
        let cost = cost + self.graph.cost(join);
        if cost < self.best[next.at()] && cost <= self.limit {
            self.best[next.at()] = cost;
            self.came_by[next.at()] = Some((join, tree));
            self.frontier.push(Reverse((cost.to_bits(), next)));
            if self.is_goal[next.at()] {
                self.limit = cost;
            }
        }
    }

    fn way_back(&self, mut tree: TreeId) -> Vec<Join> {
        let mut way = Vec::new();
        while let Some((join, before)) = self.came_by[tree.at()] {
            way.push(join);
            tree = before;
        }
        way.reverse();
        way
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foliate_components::graph::StateId;

    /// Numbers that look random, the same each time.
    struct Draw(u64);

    impl Draw {
        fn below(&mut self, count: u64) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) % count
        }
    }

    /// Anchors on few leaves in few trees, some joined by unvalidated edges, with many failed and some made joins. Distances are small whole
    /// numbers, so that many ways cost the same.
    fn graph(draw: &mut Draw) -> (LeafGraph, Vec<TreeId>, Vec<Vec<u32>>) {
        let (count, leaves, tree_count) = (2 + draw.below(60), 1 + draw.below(6), 2 + draw.below(20));
        let mut graph = LeafGraph::default();
        let mut members = vec![Vec::new(); tree_count as usize];
        let mut trees = Vec::new();
        for anchor in 0..count as u32 {
            let leaf = draw.below(leaves) as usize;
            let older = if leaf < graph.leaf_count() { graph.anchors_on(leaf).len() } else { 0 };
            let lengths = (0..older).map(|_| draw.below(4) as f64).collect();
            graph.insert(NodeId(anchor), LeafId(leaf as u32), StateId(leaf as u32 / 2), lengths);
            let tree = TreeId(draw.below(tree_count) as u32);
            members[tree.at()].push(anchor);
            trees.push(tree);
        }
        for _ in 0..count / 3 {
            let [a, b] = [0; 2].map(|_| draw.below(count) as u32);
            if a != b && [a, b].iter().all(|&anchor| graph.unvalidated_at(anchor).is_none()) {
                graph.lead(NodeId(a), NodeId(b));
            }
        }
        for _ in 0..draw.below(3 * count) {
            let [a, b] = [0; 2].map(|_| draw.below(count) as u32);
            if a != b && graph.leaf_of(a) == graph.leaf_of(b) {
                match draw.below(3) {
                    0 => graph.count_failure(Join(a.min(b), a.max(b)), 0.25 * draw.below(5) as f64),
                    made => graph.count_tried(Join(a.min(b), a.max(b)), made == 1),
                }
            }
        }
        (graph, trees, members)
    }

    /// The same by a look at all pairs of anchors of each leaf.
    fn by_all_pairs(graph: &LeafGraph, trees: &[TreeId], members: &[Vec<u32>], goals: &[TreeId]) -> Option<Vec<Join>> {
        let mut best = vec![f64::INFINITY; members.len()];
        let mut came_by: Vec<Option<(Join, TreeId)>> = vec![None; members.len()];
        let mut is_settled = vec![false; members.len()];
        best[0] = 0.0;
        loop {
            let open = (0..members.len()).filter(|&tree| !is_settled[tree] && best[tree].is_finite());
            let mut tree = open.min_by(|&a, &b| best[a].total_cmp(&best[b]))?;
            if goals.iter().any(|goal| goal.at() == tree) {
                let mut way = Vec::new();
                while let Some((join, before)) = came_by[tree] {
                    way.insert(0, join);
                    tree = before.at();
                }
                return Some(way);
            }
            is_settled[tree] = true;
            for &anchor in &members[tree] {
                let here = graph.anchors_on(graph.leaf_of(anchor).at()).iter().copied();
                for other in here.chain(graph.unvalidated_at(anchor)) {
                    let next = trees[other as usize].at();
                    let join = Join(anchor.min(other), anchor.max(other));
                    if !is_settled[next] && best[tree] + graph.cost(join) < best[next] {
                        best[next] = best[tree] + graph.cost(join);
                        came_by[next] = Some((join, TreeId(tree as u32)));
                    }
                }
            }
        }
    }

    #[test]
    fn the_answer_is_that_of_a_search_over_all_pairs() {
        let mut draw = Draw(1);
        let (mut found, mut longest) = (0, 0);
        for _ in 0..3000 {
            let (graph, trees, members) = graph(&mut draw);
            let goals: Vec<_> =
                (0..1 + draw.below(3)).map(|_| TreeId(1 + draw.below(members.len() as u64 - 1) as u32)).collect();
            let way = cheapest_way(&graph, &trees, &members, TreeId(0), &goals);
            assert_eq!(way, by_all_pairs(&graph, &trees, &members, &goals));
            found += usize::from(way.is_some());
            longest = longest.max(way.map_or(0, |way| way.len()));
        }
        assert!(found > 1500 && longest > 3, "{found} ways, the longest of {longest} joins");
    }
}
