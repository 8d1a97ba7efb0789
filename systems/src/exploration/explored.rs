//! Which trees count as one ([`SearchSides`]), and a view of all that the trees have reached ([`Explored`]).

use crate::exploration::reached_leaves::ReachedLeaves;
use bevy_ecs::prelude::{Res, Resource};
use bevy_ecs::system::SystemParam;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::roadmap::{ComponentId, NodeId, Roadmap};

/// On whose behalf each tree grows.
///
/// A tree that was planted hangs together with nothing yet, but it counts to the tree from whose leaf it was planted as if
/// the two were joined: they share what they have reached, and are no rendezvous for one another. Kept by the commit.
#[derive(Clone, Debug, Default, Resource)]
pub struct SearchSides {
    /// By tree as born: the root tree of its family.
    pub(crate) of: Vec<ComponentId>,
}

impl SearchSides {
    /// The root tree on whose behalf a tree was born; the tree itself where it was not planted.
    #[must_use]
    pub fn side_root(&self, tree: ComponentId) -> ComponentId {
        self.of.get(tree.at()).copied().unwrap_or(tree)
    }

    /// The tree that now contains the root tree of a tree's family.
    #[must_use]
    pub fn search_side(&self, roadmap: &Roadmap, tree: ComponentId) -> ComponentId {
        roadmap.component(self.side_root(tree))
    }

    /// The family of a node.
    #[must_use]
    pub fn side_of(&self, roadmap: &Roadmap, node: NodeId) -> ComponentId {
        self.search_side(roadmap, roadmap.node(node).component)
    }
}

/// What the trees have reached so far, for systems that choose.
#[derive(SystemParam)]
pub struct Explored<'w> {
    /// Nodes and edges.
    pub roadmap: Res<'w, Roadmap>,
    /// Leaves and parameters.
    pub leaves: Res<'w, LeafIndex>,
    /// Leaves by tree.
    pub reached: Res<'w, ReachedLeaves>,
    /// Trees that count as one.
    pub search_sides: Res<'w, SearchSides>,
}

impl Explored<'_> {
    /// The trees that have not been absorbed by another and were not planted for one, by id.
    pub fn trees(&self) -> impl Iterator<Item = ComponentId> {
        (0..self.roadmap.trees() as u32)
            .map(ComponentId)
            .filter(|&c| self.search_sides.search_side(&self.roadmap, c) == c)
    }
}
