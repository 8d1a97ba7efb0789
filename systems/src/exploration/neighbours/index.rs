//! The nodes by leaf, state and tree, with their coordinates in blocks of lanes: what the queries of this module read.

use crate::planning_model::model::PlanningModel;
use crate::settings::{SearchSettings, Selection};
use bevy_ecs::prelude::Resource;
use foliate_components::graph::leaf::LeafId;
use foliate_components::roadmap::{NodeId, Roadmap, TreeId};
use foliate_kernels::lanes::Level;
use foliate_kernels::nearest::{Bucket, Metric};
use std::collections::HashMap;

/// Nodes of a leaf from which on they lie in lanes.
const CROWD: usize = 32;

/// The nodes of a leaf or a state, by the tree in which they were born.
pub(crate) type ByTree = Vec<(TreeId, Bucket)>;

/// The nodes of the roadmap, in a form for queries of near ones.
#[derive(Clone, Debug, Resource)]
pub struct Neighbours {
    pub(crate) level: Level,
    /// Of the robots alone: on a leaf the attachments of objects are constant.
    pub(crate) robots: Metric,
    pub(crate) everything: Metric,
    /// Leaves with many nodes.
    pub(crate) leaves: HashMap<LeafId, ByTree>,
    /// States, where nodes are chosen among all of a state or of the roadmap.
    pub(crate) states: Option<Vec<ByTree>>,
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
    pub(crate) fn add(&mut self, roadmap: Roadmap<'_>, node: NodeId) {
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
        all.flatten().map(|(_, bucket)| size_of::<(TreeId, Bucket)>() + bucket.bytes()).sum()
    }
}

fn push(buckets: &mut ByTree, metric: &Metric, roadmap: Roadmap<'_>, node: NodeId) {
    let born = roadmap.node(node).tree;
    let at = buckets.iter().position(|(tree, _)| *tree == born).unwrap_or_else(|| {
        buckets.push((born, Bucket::default()));
        buckets.len() - 1
    });
    buckets[at].1.push(metric, node.0, roadmap.configuration(node));
}
