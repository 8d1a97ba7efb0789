//! Which nodes are nearest: on a leaf, in a state, of the whole roadmap. Kept by the commit, asked by Select and Connect.
//!
//! Few nodes are measured one by one. Where a leaf has more, their coordinates lie in blocks of lanes too, by the tree in
//! which they were born ([`foliate_kernels::nearest`]); the answer is the same bit for bit.

use crate::model::PlanningModel;
use crate::settings::{SearchSettings, Selection};
use bevy_ecs::prelude::Resource;
use foliate_components::graph::StateId;
use foliate_components::leaf::LeafId;
use foliate_components::roadmap::{ComponentId, NodeId, Roadmap};
use foliate_kernels::lanes::Level;
use foliate_kernels::nearest::{Bucket, BucketQuery, Metric, nearest};
use std::collections::HashMap;

/// Nodes of a leaf from which on they lie in lanes.
const CROWD: usize = 32;

/// The nodes of a leaf or a state, by the tree in which they were born.
type ByTree = Vec<(ComponentId, Bucket)>;

/// The nodes of the roadmap, as whoever looks for near ones wants them.
#[derive(Clone, Debug, Resource)]
pub struct Neighbours {
    level: Level,
    /// Of the robots alone: on a leaf objects hang where they hang.
    robots: Metric,
    everything: Metric,
    /// Leaves with many nodes.
    leaves: HashMap<LeafId, ByTree>,
    /// States, where nodes are chosen among all of a state or of the roadmap.
    states: Option<Vec<ByTree>>,
}

impl Neighbours {
    /// For an empty roadmap.
    #[must_use]
    pub fn new(model: &PlanningModel, settings: &SearchSettings) -> Self {
        let space = &model.problem.robot.space;
        let by_state = matches!(settings.selection, Selection::StateFirst | Selection::Nearest);
        Self {
            level: settings.level,
            robots: Metric::new(space, &model.robot_weights),
            everything: Metric::new(space, &model.weights),
            leaves: HashMap::new(),
            states: by_state.then(Vec::new),
        }
    }

    /// Adds the node that the roadmap has got last.
    pub(crate) fn add(&mut self, roadmap: &Roadmap, node: NodeId) {
        let row = roadmap.node(node);
        if let Some(states) = &mut self.states {
            if states.len() <= row.state.at() {
                states.resize_with(row.state.at() + 1, Vec::new);
            }
            push(&mut states[row.state.at()], &self.everything, roadmap, node);
        }
        let on_leaf = roadmap.nodes_on(row.leaf);
        if on_leaf.len() == CROWD {
            let buckets = self.leaves.entry(row.leaf).or_default();
            on_leaf.iter().for_each(|&node| push(buckets, &self.robots, roadmap, node));
        } else if on_leaf.len() > CROWD
            && let Some(buckets) = self.leaves.get_mut(&row.leaf)
        {
            push(buckets, &self.robots, roadmap, node);
        }
    }

    /// Memory of the blocks, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let all = self.leaves.values().chain(self.states.iter().flatten());
        all.flatten().map(|(_, bucket)| size_of::<(ComponentId, Bucket)>() + bucket.bytes()).sum()
    }

    /// The node on a leaf that is nearest to `q`, robots alone, of the trees (as they were born) that are wanted; ties by
    /// lowest id.
    #[must_use]
    pub fn nearest_on(
        &self,
        model: &PlanningModel,
        roadmap: &Roadmap,
        q: &[f64],
        leaf: LeafId,
        wanted: impl Fn(ComponentId) -> bool,
    ) -> Option<NodeId> {
        let Some(buckets) = self.leaves.get(&leaf) else {
            let nodes = roadmap.nodes_on(leaf).iter().copied().filter(|&node| wanted(roadmap.node(node).component));
            return model.nearest(roadmap, q, nodes, &model.robot_weights);
        };
        let of_tree = buckets.iter().filter(|(born, _)| wanted(*born));
        self.among(model, roadmap, q, (&self.robots, &model.robot_weights), of_tree)
    }

    /// The node in a state that is nearest to `q`, of the trees (as they were born) that are wanted; ties by lowest id.
    #[must_use]
    pub fn nearest_in(
        &self,
        model: &PlanningModel,
        roadmap: &Roadmap,
        q: &[f64],
        state: StateId,
        wanted: impl Fn(ComponentId) -> bool,
    ) -> Option<NodeId> {
        let Some(states) = &self.states else {
            let nodes = (0u32..).map(NodeId).zip(roadmap.nodes());
            let nodes = nodes.filter(|(_, row)| row.state == state && wanted(row.component));
            return model.nearest(roadmap, q, nodes.map(|(node, _)| node), &model.weights);
        };
        let of_tree = states.get(state.at()).into_iter().flatten();
        let of_tree = of_tree.filter(|(born, _)| wanted(*born));
        self.among(model, roadmap, q, (&self.everything, &model.weights), of_tree)
    }

    /// The node of the whole roadmap that is nearest to `q`; ties by lowest id.
    #[must_use]
    pub fn nearest_of_all(&self, model: &PlanningModel, roadmap: &Roadmap, q: &[f64]) -> Option<NodeId> {
        let Some(states) = &self.states else {
            let all = (0..roadmap.nodes().len() as u32).map(NodeId);
            return model.nearest(roadmap, q, all, &model.weights);
        };
        self.among(model, roadmap, q, (&self.everything, &model.weights), states.iter().flatten())
    }

    /// The `count` nodes of each other tree on the node's leaf that are nearest to it, robots alone: by tree, distance, id.
    #[must_use]
    pub fn of_other_trees(&self, model: &PlanningModel, roadmap: &Roadmap, node: NodeId, count: usize) -> Vec<NodeId> {
        let (tree, q, leaf) = (roadmap.component_of(node), roadmap.configuration(node), roadmap.node(node).leaf);
        let distance =
            |other: NodeId| model.problem.robot.space.distance(q, roadmap.configuration(other), &model.robot_weights);
        let mut nearest: Vec<(ComponentId, Vec<(f64, NodeId)>)> = Vec::new();
        match self.leaves.get(&leaf) {
            None => {
                for &other in roadmap.nodes_on(leaf) {
                    let component = roadmap.component_of(other);
                    if component != tree {
                        keep(of_tree(&mut nearest, component), (distance(other), other), count);
                    }
                }
            }
            Some(buckets) => {
                let query = BucketQuery::new(&self.robots, q);
                for (born, bucket) in buckets {
                    let component = roadmap.component(*born);
                    if component != tree {
                        let kept = of_tree(&mut nearest, component);
                        let cutoff = cutoff(kept, count);
                        bucket.visit_near((&self.robots, &query, self.level), cutoff, |id| {
                            keep(kept, (distance(NodeId(id)), NodeId(id)), count)
                        });
                    }
                }
            }
        }
        nearest.into_iter().flat_map(|(_, nodes)| nodes).map(|(_, node)| node).collect()
    }

    fn among<'b>(
        &self,
        model: &PlanningModel,
        roadmap: &Roadmap,
        q: &[f64],
        (metric, weights): (&Metric, &[f64]),
        buckets: impl Iterator<Item = &'b (ComponentId, Bucket)>,
    ) -> Option<NodeId> {
        let space = &model.problem.robot.space;
        let query = BucketQuery::new(metric, q);
        let distance = |id: u32| space.distance(q, roadmap.configuration(NodeId(id)), weights);
        nearest((metric, &query, self.level), buckets.map(|(_, bucket)| bucket), distance).map(NodeId)
    }
}

fn push(buckets: &mut ByTree, metric: &Metric, roadmap: &Roadmap, node: NodeId) {
    let born = roadmap.node(node).component;
    let at = buckets.iter().position(|(tree, _)| *tree == born).unwrap_or_else(|| {
        buckets.push((born, Bucket::default()));
        buckets.len() - 1
    });
    buckets[at].1.push(metric, node.0, roadmap.configuration(node));
}

/// A tree's entry in a list sorted by tree.
fn of_tree<T: Default>(trees: &mut Vec<(ComponentId, T)>, tree: ComponentId) -> &mut T {
    let at = trees.partition_point(|(known, _)| *known < tree);
    if trees.get(at).is_none_or(|(known, _)| *known != tree) {
        trees.insert(at, (tree, T::default()));
    }
    &mut trees[at].1
}

/// Keeps the `count` nearest, by distance and id; answers from which distance on nodes are too far.
fn keep(kept: &mut Vec<(f64, NodeId)>, new: (f64, NodeId), count: usize) -> f64 {
    let at = kept.partition_point(|old| old.0.total_cmp(&new.0).then(old.1.cmp(&new.1)).is_lt());
    if at < count {
        kept.insert(at, new);
        kept.truncate(count);
    }
    cutoff(kept, count)
}

fn cutoff(kept: &[(f64, NodeId)], count: usize) -> f64 {
    match kept.last() {
        Some(&(far, _)) if kept.len() >= count => far,
        _ => f64::INFINITY,
    }
}
