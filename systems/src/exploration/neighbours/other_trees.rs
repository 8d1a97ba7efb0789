//! The nearest nodes of other trees: nodes of one leaf and tree ask together.

use crate::exploration::neighbours::index::Neighbours;
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::runs;
use foliate_components::graph::leaf::LeafId;
use foliate_components::roadmap::{NodeId, Roadmap, TreeId};
use foliate_kernels::nearest::{Bucket, BucketQueries, Seeker};

/// A node that asks, and what it gets.
struct Asker {
    leaf: LeafId,
    tree: TreeId,
    /// Its place in the caller's list.
    place: usize,
    node: NodeId,
    nearest: Vec<NodeId>,
}

/// The nearest of one tree to each of several askers, by distance and id.
pub(crate) struct Nearest<D> {
    kept: Vec<Vec<(f64, NodeId)>>,
    count: usize,
    distance: D,
}

impl Neighbours {
    /// For each node of a list the `count` nodes of each other tree on its leaf that are nearest to it, robots alone: pairs by
    /// place in the list, tree, distance, id.
    #[must_use]
    pub fn of_other_trees(
        &self,
        model: &PlanningModel,
        roadmap: Roadmap<'_>,
        nodes: &[NodeId],
        count: usize,
    ) -> Vec<(NodeId, NodeId)> {
        let asker = |(place, &node): (usize, &NodeId)| {
            let (leaf, tree) = (roadmap.node(node).leaf, roadmap.tree_of(node));
            Asker { leaf, tree, place, node, nearest: Vec::new() }
        };
        let mut askers: Vec<_> = nodes.iter().enumerate().map(asker).collect();
        let kind = |asker: &Asker| (asker.leaf, asker.tree);
        askers.sort_unstable_by_key(|asker| (kind(asker), asker.place));
        runs(
            &mut askers,
            |a, b| kind(a) == kind(b),
            BucketQueries::default,
            |queries, run| {
                self.of_other_trees_together((model, roadmap), queries, run, count);
            },
        );
        askers.sort_unstable_by_key(|asker| asker.place);
        askers.iter().flat_map(|asker| asker.nearest.iter().map(|&other| (asker.node, other))).collect()
    }

    /// The same for nodes of one leaf and tree.
    fn of_other_trees_together(
        &self,
        (model, roadmap): (&PlanningModel, Roadmap<'_>),
        queries: &mut BucketQueries,
        askers: &mut [Asker],
        count: usize,
    ) {
        let Some((leaf, tree)) = askers.first().map(|asker| (asker.leaf, asker.tree)) else { return };
        let (space, weights) = (&model.problem.robot.space, &model.robot_weights);
        let distance =
            |a: NodeId, b: NodeId| space.distance(roadmap.configuration(a), roadmap.configuration(b), weights);
        let Some(buckets) = self.leaves.get(&leaf) else {
            return askers.iter_mut().for_each(|asker| {
                let others = roadmap.nodes_on(leaf).iter().map(|&node| (roadmap.tree_of(node), node));
                let others = others.filter(|&(of, _)| of != tree);
                let mut others: Vec<_> = others.map(|(of, node)| (of, distance(asker.node, node), node)).collect();
                others.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
                let trees = others.chunk_by(|a, b| a.0 == b.0);
                asker.nearest.extend(trees.flat_map(|tree| tree.iter().take(count)).map(|&(_, _, node)| node));
            });
        };
        let others = buckets.iter().map(|(born, bucket)| (roadmap.tree(*born), bucket));
        let mut others: Vec<(TreeId, &Bucket)> = others.filter(|&(of, _)| of != tree).collect();
        if others.is_empty() {
            return;
        }
        others.sort_by_key(|&(of, _)| of);
        queries.set(&self.robots, askers.iter().map(|asker| roadmap.configuration(asker.node)));
        let mut kept = vec![Vec::with_capacity(count + 1); askers.len()];
        for of_tree in others.chunk_by(|a, b| a.0 == b.0) {
            let from_asker = |query: usize, id: u32| distance(askers[query].node, NodeId(id));
            let mut seeker = Nearest { kept, count, distance: from_asker };
            of_tree.iter().for_each(|(_, bucket)| bucket.visit_near((&self.robots, queries, self.level), &mut seeker));
            kept = seeker.kept;
            let by_asker = askers.iter_mut().zip(&mut kept);
            by_asker.for_each(|(asker, kept)| asker.nearest.extend(kept.drain(..).map(|(_, node)| node)));
        }
    }
}

impl<D: Fn(usize, u32) -> f64> Seeker for Nearest<D> {
    fn cutoff(&self, query: usize) -> f64 {
        let kept = &self.kept[query];
        match kept.last() {
            Some(&(far, _)) if kept.len() >= self.count => far,
            _ => f64::INFINITY,
        }
    }

    fn measure(&mut self, query: usize, id: u32) {
        let (new, kept) = (((self.distance)(query, id), NodeId(id)), &mut self.kept[query]);
        let at = kept.partition_point(|old| old.0.total_cmp(&new.0).then(old.1.cmp(&new.1)).is_lt());
        if at < self.count {
            kept.insert(at, new);
            kept.truncate(self.count);
        }
    }
}
