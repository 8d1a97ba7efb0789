//! One view of all that the trees have reached.

use crate::exploration::reached_leaves::ReachedLeaves;
use crate::exploration::roadmap_query::RoadmapQuery;
use bevy_ecs::prelude::Res;
use bevy_ecs::system::SystemParam;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::roadmap::Roadmap;

/// What the trees have reached so far, for systems that choose.
#[derive(SystemParam)]
pub struct Explored<'w, 's> {
    nodes_and_edges: RoadmapQuery<'w, 's>,
    /// Leaves and parameters.
    pub leaves: Res<'w, LeafIndex>,
    /// Leaves by tree.
    pub reached: Res<'w, ReachedLeaves>,
}

impl Explored<'_, '_> {
    /// Nodes, edges and trees.
    #[must_use]
    pub fn roadmap(&self) -> Roadmap<'_> {
        self.nodes_and_edges.view()
    }
}
