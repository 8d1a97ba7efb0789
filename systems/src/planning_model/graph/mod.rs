//! The constraint graph (P0 §II-D, P1 Algorithm 1): whole, or growing while it is searched; and what follows what in its
//! states.

pub mod attachment_order;
pub mod checks;
pub mod enumeration;
pub(crate) mod lazy_graph;
pub(crate) mod state_keys;
pub mod support_placement;
pub mod transitions;
