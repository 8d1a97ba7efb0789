//! What entities cost, for the counts of memory.

/// An entity's id in its table, its entries in the lists of its archetype and of the world, and its share of what these
/// leave unused: as measured (`systems/tests/nodes_are_small.rs`).
pub(crate) const ENTITY_BYTES: usize = 76;

/// When a component was added and when it last changed.
pub(crate) const TICK_BYTES: usize = 8;
