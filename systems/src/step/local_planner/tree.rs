//! A tree of configurations of one leaf, each with the certified motion that leads to it.

use crate::step::local_planner::leaf_space::Extension;
use foliate_components::roadmap::NodeId;
use foliate_components::robot::configuration::ConfigurationSpace;

/// Where a vertex comes from.
#[derive(Clone, Debug)]
enum Origin {
    /// It is a node of the roadmap.
    Node(NodeId),
    /// The motion from another vertex, by number.
    Motion(u32, Extension),
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    configurations: Vec<f64>,
    origins: Vec<Origin>,
    bytes: u64,
}

impl Tree {
    /// Adds a node of the roadmap.
    pub fn add_node(&mut self, node: NodeId, q: &[f64]) {
        self.bytes += (size_of_val(q) + size_of::<Origin>()) as u64;
        self.configurations.extend_from_slice(q);
        self.origins.push(Origin::Node(node));
    }

    /// Adds where a motion from a vertex leads; returns the new vertex.
    pub fn add(&mut self, from: u32, motion: Extension, size: usize) -> u32 {
        let q = motion.end(size);
        self.bytes += (size_of_val(q) + size_of::<Origin>() + size_of_val(&*motion.knots)) as u64;
        self.configurations.extend_from_slice(q);
        self.origins.push(Origin::Motion(from, motion));
        self.origins.len() as u32 - 1
    }

    /// Number of vertices.
    #[must_use]
    pub fn len(&self) -> usize {
        self.origins.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.origins.is_empty()
    }

    /// The configuration of a vertex.
    #[must_use]
    pub fn configuration(&self, vertex: u32, size: usize) -> &[f64] {
        &self.configurations[vertex as usize * size..][..size]
    }

    /// The vertex nearest to a configuration, by weighted distance; ties by lowest number.
    #[must_use]
    pub fn nearest(&self, q: &[f64], space: &ConfigurationSpace, weights: &[f64]) -> u32 {
        let far = |(vertex, other): (u32, &[f64])| (space.distance(q, other, weights), vertex);
        let all = (0..).zip(self.configurations.chunks_exact(q.len())).map(far);
        all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map_or(0, |(_, vertex)| vertex)
    }

    /// The node from which a vertex was reached, and the motions from there, in order.
    #[must_use]
    pub fn path_to(&self, mut vertex: u32) -> (Option<NodeId>, Vec<&Extension>) {
        let mut motions = Vec::new();
        loop {
            match &self.origins[vertex as usize] {
                Origin::Node(node) => {
                    motions.reverse();
                    return (Some(*node), motions);
                }
                Origin::Motion(from, motion) => {
                    motions.push(motion);
                    vertex = *from;
                }
            }
        }
    }

    /// About how much memory it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}
