//! The roots of the trees of start and goals, and how a search has ended.

use bevy_ecs::prelude::Resource;
use foliate_components::outcome::SearchOutcome;
use foliate_components::roadmap::{NodeId, Roadmap};

/// The roots of the trees that are to meet.
#[derive(Clone, Debug, Default, Resource)]
pub struct Roots {
    /// Root of the start's tree.
    pub start: Option<NodeId>,
    /// Roots of the goals' trees.
    pub goals: Vec<NodeId>,
}

/// Roots whose configuration was given with fingers elsewhere, and that configuration: there a path begins or ends.
#[derive(Clone, Debug, Default, Resource)]
pub struct GivenRoots(pub Vec<(NodeId, Vec<f64>)>);

impl GivenRoots {
    /// The configuration of a root as it was given, where that is another one.
    #[must_use]
    pub fn of(&self, root: NodeId) -> Option<&[f64]> {
        self.0.iter().find(|(node, _)| *node == root).map(|(_, q)| q.as_slice())
    }
}

/// How the search has ended, once it has.
#[derive(Clone, Debug, Default, Resource)]
pub struct Ending(pub Option<SearchOutcome>);

impl Roots {
    /// The first goal that is connected to the start.
    #[must_use]
    pub fn reached_goal(&self, roadmap: Roadmap<'_>) -> Option<NodeId> {
        let start = roadmap.tree_of(self.start?);
        self.goals.iter().copied().find(|&goal| roadmap.tree_of(goal) == start)
    }
}
