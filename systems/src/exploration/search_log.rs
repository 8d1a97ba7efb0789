//! What a recording of a search tells and its entities do not keep: when nodes and edges came, which edges were refused, and
//! where pairs of shapes were found too close.
//!
//! A world has a log only where [`SearchSettings::log`](crate::settings::SearchSettings::log) asks for one. Nodes and edges keep their order of
//! arrival, so that their counts after each step say in which step each of them came; nothing is written where they are added.

use crate::schedule::StepCounter;
use bevy_ecs::prelude::{Resource, World};
use foliate_components::graph::TransitionId;
use foliate_components::roadmap::{EdgeId, NodeId, RoadmapStore};
use foliate_components::robot::ShapeIndex;
use std::collections::BTreeMap;

/// Pairs, by transition, of which a configuration is kept; the first that come.
pub const MOST_COLLISIONS: usize = 4096;

/// Refused edges that are kept; the first that come.
pub const MOST_REFUSED: usize = 1 << 17;

/// How large the roadmap was once a step had ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct StepEnd {
    step: u64,
    nodes: u32,
    edges: u32,
}

/// An edge that was not validated, and then found not to be free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RefusedEdge {
    /// Where its motions start.
    pub from: NodeId,
    /// Where they end.
    pub to: NodeId,
    /// Transition that it travels.
    pub along: TransitionId,
    /// The step in which it was refused.
    pub step: u64,
}

/// Two shapes that stopped candidates of a transition.
pub type BlockedPair = (TransitionId, (ShapeIndex, ShapeIndex));

/// The log of a search.
///
/// It takes 16 bytes for each step in which something was added, and what [`MOST_COLLISIONS`] configurations and [`MOST_REFUSED`] edges take.
/// Limits of memory do not count it, so that the answer is the same with it and without.
#[derive(Clone, Debug, Default, PartialEq, Resource)]
pub struct SearchLog {
    ends: Vec<StepEnd>,
    refused: Vec<RefusedEdge>,
    collisions: BTreeMap<BlockedPair, Box<[f64]>>,
    /// Refused edges that came too late to be kept.
    pub refused_left_out: u64,
}

impl SearchLog {
    /// The step in which a node came: 0 of roots that were there before the first step, the last known of those that came since.
    #[must_use]
    pub fn step_of_node(&self, node: NodeId) -> u64 {
        self.step_at(self.ends.partition_point(|end| end.nodes <= node.0))
    }

    /// The step in which an edge was validated.
    #[must_use]
    pub fn step_of_edge(&self, edge: EdgeId) -> u64 {
        self.step_at(self.ends.partition_point(|end| end.edges <= edge.0))
    }

    fn step_at(&self, place: usize) -> u64 {
        self.ends.get(place).or(self.ends.last()).map_or(0, |end| end.step)
    }

    /// Edges that were refused, in order.
    #[must_use]
    pub fn refused(&self) -> &[RefusedEdge] {
        &self.refused
    }

    /// For pairs that stopped candidates: a configuration at which the pair was found too close.
    #[must_use]
    pub fn collisions(&self) -> &BTreeMap<BlockedPair, Box<[f64]>> {
        &self.collisions
    }

    /// Whether a configuration of a pair would be kept.
    #[must_use]
    pub fn wants(&self, pair: BlockedPair) -> bool {
        self.collisions.len() < MOST_COLLISIONS && !self.collisions.contains_key(&pair)
    }

    /// Keeps a configuration at which a pair was found too close, unless there is one.
    pub fn note_collision(&mut self, pair: BlockedPair, q: &[f64]) {
        if self.wants(pair) {
            self.collisions.insert(pair, q.into());
        }
    }

    /// Keeps an edge that was refused.
    pub(crate) fn note_refused(&mut self, edge: RefusedEdge) {
        if self.refused.len() < MOST_REFUSED {
            self.refused.push(edge);
        } else {
            self.refused_left_out += 1;
        }
    }

    fn note_step(&mut self, step: u64, nodes: u32, edges: u32) {
        let last = self.ends.last().map_or((0, 0), |end| (end.nodes, end.edges));
        if last != (nodes, edges) {
            self.ends.push(StepEnd { step, nodes, edges });
        }
    }
}

/// Notes in the log of a world, if it has one, how large the roadmap is by now.
pub(crate) fn note_step(world: &mut World) {
    if !world.contains_resource::<SearchLog>() {
        return;
    }
    let (step, store) = (world.resource::<StepCounter>().step, world.resource::<RoadmapStore>());
    let (nodes, edges) = (store.nodes() as u32, store.edges() as u32);
    world.resource_mut::<SearchLog>().note_step(step, nodes, edges);
}

/// Notes in the log of a world, if it has one, where a pair was found too close.
pub(crate) fn note_collision(world: &mut World, pair: BlockedPair, q: &[f64]) {
    if let Some(mut log) = world.get_resource_mut::<SearchLog>() {
        log.note_collision(pair, q);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_and_edges_have_the_step_after_which_they_were_first_seen() {
        let mut log = SearchLog::default();
        for (step, nodes, edges) in [(0, 2, 0), (1, 2, 0), (2, 5, 1), (7, 6, 1), (8, 6, 3)] {
            log.note_step(step, nodes, edges);
        }
        let nodes: Vec<u64> = (0..7).map(|node| log.step_of_node(NodeId(node))).collect();
        assert_eq!(nodes, [0, 0, 2, 2, 2, 7, 8]);
        let edges: Vec<u64> = (0..3).map(|edge| log.step_of_edge(EdgeId(edge))).collect();
        assert_eq!(edges, [2, 8, 8]);
        assert_eq!(SearchLog::default().step_of_node(NodeId(0)), 0);
    }

    #[test]
    fn the_first_configuration_of_a_pair_stays_and_there_are_not_too_many() {
        let mut log = SearchLog::default();
        let pair = |number: usize| (TransitionId(number as u32), (ShapeIndex(0), ShapeIndex(1)));
        (0..MOST_COLLISIONS + 5).for_each(|number| log.note_collision(pair(number), &[number as f64]));
        log.note_collision(pair(3), &[-1.0]);
        assert_eq!(log.collisions().len(), MOST_COLLISIONS);
        assert_eq!(*log.collisions()[&pair(3)], [3.0]);
    }
}
