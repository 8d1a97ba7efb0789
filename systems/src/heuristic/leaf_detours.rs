//! What stands in the way between leaves, as far as it adds to their distance.

use crate::exploration::explored::Explored;
use crate::heuristic::blocking::MoveOrder;
use crate::heuristic::leaf_distance_table::End;
use crate::heuristic::leaf_heuristic::LeafHeuristic;
use crate::heuristic::weighted_leaves::in_state;
use crate::planning_model::model::Model;
use foliate_components::graph::ConstraintGraph;
use foliate_components::graph::leaf::LeafId;
use foliate_components::roadmap::TreeId;
use foliate_kernels::lanes::Level;
use std::cmp::Reverse;

/// To so many leaves it is asked what stands in the way.
const TARGETS: usize = 4;

impl LeafHeuristic {
    /// Asks what stands in the way from a leaf to the nearest ones of other trees; true where it was told something else before.
    pub(crate) fn follow_order(
        &mut self,
        model: &Model,
        explored: &Explored<'_, '_>,
        level: Level,
        order: &mut MoveOrder,
        (tree, leaf): (TreeId, LeafId),
    ) -> bool {
        if !order.is_known() {
            return false;
        }
        let (leaves, from) = (&explored.leaves, explored.leaves.leaf(leaf));
        let targets = self.nearest_targets(&model.graph, explored, level, (leaf, tree));
        let ways =
            targets.iter().map(|&(far, to)| far.saturating_add(order.detours(model, leaves, from, leaves.leaf(to))));
        let (Some(way), Some(far)) = (ways.min(), self.to_others(leaf, tree)) else { return false };
        self.detours.resize(leaves.leaves().len(), 0);
        let detours = way.saturating_sub(far);
        let has_changed = std::mem::replace(&mut self.detours[leaf.at()], detours) != detours;
        if let Some(leaves) = self.trees.get_mut(tree.at()).and_then(|states| in_state(states, from.state)) {
            leaves.change(leaf, |weighted| weighted.detours = detours);
        }
        has_changed
    }

    /// The leaves of other trees that are nearest to a leaf, those that no way leads to left out; of equals the newest.
    fn nearest_targets(
        &self,
        graph: &ConstraintGraph,
        explored: &Explored<'_, '_>,
        level: Level,
        (leaf, tree): (LeafId, TreeId),
    ) -> Vec<(u16, LeafId)> {
        let from = explored.leaves.leaf(leaf);
        let mut nearest: Vec<(u16, LeafId)> = Vec::with_capacity(TARGETS + 1);
        let mut far = Vec::new();
        for (born, list) in (0u32..).map(TreeId).zip(&explored.reached.by_born_tree) {
            let other = explored.roadmap().tree(born);
            if other == tree {
                continue;
            }
            for columns in explored.reached.columns_of(born) {
                let pair = self.pair(graph, from.state, columns.state);
                let most = nearest.get(TARGETS - 1).map_or(u16::MAX, |&(far, _)| far);
                if pair.least > most {
                    continue;
                }
                far.clear();
                far.resize(columns.len(), 0);
                pair.distances(&from.parameters, End::From, &columns.parameters).measure(level, &mut far);
                for (&far, &place) in far.iter().zip(&columns.places).filter(|&(&far, _)| far <= most) {
                    let to = list[place as usize];
                    if !self.lost.contains(&(other, to)) {
                        let at = nearest.partition_point(|&(f, l)| (f, Reverse(l)) < (far, Reverse(to)));
                        nearest.insert(at, (far, to));
                        nearest.truncate(TARGETS);
                    }
                }
            }
        }
        nearest
    }
}
