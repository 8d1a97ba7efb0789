//! Which distance tables are known.

use crate::heuristic::leaf_distance_table::LeafDistanceTable;
use foliate_components::graph::StateId;

/// Distances between the leaves of two states, by the states.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairTables(Vec<Vec<Option<Box<LeafDistanceTable>>>>);

impl PairTables {
    /// Forgets all: the graph has changed.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    /// The table of two states, where it is known.
    pub(crate) fn get(&self, from: StateId, to: StateId) -> Option<&LeafDistanceTable> {
        self.0.get(from.at())?.get(to.at())?.as_deref()
    }

    /// The table of two states, made where it is not known.
    pub(crate) fn get_or_insert(
        &mut self,
        (from, to): (StateId, StateId),
        table: impl FnOnce() -> LeafDistanceTable,
    ) -> &LeafDistanceTable {
        if self.0.len() <= from.at() {
            self.0.resize_with(from.at() + 1, Vec::new);
        }
        let row = &mut self.0[from.at()];
        if row.len() <= to.at() {
            row.resize_with(to.at() + 1, || None);
        }
        row[to.at()].get_or_insert_with(|| Box::new(table()))
    }
}
