//! The constraint graph (P0 §II-D, P1 Algorithm 1): whole, or growing while it is searched; and what follows what in its
//! states.

pub mod building;
pub mod carriers;
pub(crate) mod cases;
pub(crate) mod growth;
pub mod resting;
