//! Dense ids of nodes, edges and trees.
//!
//! A node's id is the row of its entity among all nodes, and so is an edge's: entities of one kind are spawned one after
//! another and keep their archetype. Rows are slices, and a slice index costs a tenth of an access by entity.

macro_rules! dense_id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);

        impl $name {
            /// The index, for slices.
            #[must_use]
            pub fn at(self) -> usize {
                self.0 as usize
            }
        }
    };
}

dense_id! {
    /// A roadmap node; also the index of its configuration.
    NodeId
}
dense_id! {
    /// A validated edge.
    EdgeId
}
dense_id! {
    /// A tree of the roadmap as it was born, numbered by its root. [`Roadmap::tree`](crate::roadmap::Roadmap::tree) tells
    /// the tree that it belongs to by now.
    TreeId
}
