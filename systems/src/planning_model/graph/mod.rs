//! The constraint graph (P0 §II-D, P1 Algorithm 1): built whole, or growing while it is searched.
//!
//! `support_placement` says how an object may rest, `snapping` moves start and goals onto the nearest state, `attachment_order` in which order the objects of a state follow their
//! carriers. `checks` refuses problems of which no graph can be built. `states` distinguishes states by what they require,
//! `builder` adds them to a graph, `transitions` and `legs` have the parts of transitions. `enumeration` builds a whole graph from these;
//! `lazy_graph` builds the same states and transitions one by one. `connected_states` says which of them a path can pass.

pub mod attachment_order;
pub(crate) mod builder;
pub mod checks;
pub mod connected_states;
pub mod enumeration;
pub(crate) mod lazy_graph;
pub(crate) mod legs;
pub(crate) mod snapping;
pub(crate) mod states;
pub mod support_placement;
pub mod transitions;
