//! How far the leaves of a tree are from other trees, as they were measured.

use foliate_components::roadmap::{Roadmap, TreeId};

/// What is known of the leaves that a tree reached while it had its own id.
#[derive(Clone, Debug, Default)]
pub(crate) struct Measured {
    /// How many, in order of first visit.
    pub(crate) known: usize,
    /// By state, in the order of [`ReachedLeaves::columns_of`].
    pub(crate) states: Vec<Nearest>,
}

/// Of the leaves of one state: changes of grasp to the nearest leaf of every tree as it was born, by tree and leaf. Trees
/// that have been joined to the leaves' own are left out.
#[derive(Clone, Debug, Default)]
pub(crate) struct Nearest {
    pub(crate) known: usize,
    /// How many of them were before the graph last grew, which may have brought all closer.
    pub(crate) stale: usize,
    pub(crate) by_tree: Vec<Vec<u16>>,
}

impl Nearest {
    pub(crate) fn of(&mut self, tree: usize) -> &mut Vec<u16> {
        if self.by_tree.len() <= tree {
            self.by_tree.resize_with(tree + 1, Vec::new);
        }
        let row = &mut self.by_tree[tree];
        row.resize(self.known, u16::MAX);
        row
    }

    /// To the nearest leaf of any tree but `own`.
    pub(crate) fn to_others(&self, roadmap: Roadmap<'_>, own: TreeId, leaf: usize) -> Option<u16> {
        let others = (0u32..).map(TreeId).zip(&self.by_tree);
        let others = others.filter(|(c, row)| !row.is_empty() && roadmap.tree(*c) != own);
        others.map(|(_, row)| row.get(leaf).copied().unwrap_or(u16::MAX)).min()
    }
}
