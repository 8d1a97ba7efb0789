//! Narrow phase: what exact queries decide about pairs that the bounds leave open.
//!
//! `settings` says what a certificate has to prove. `pair_at_sample` decides one pair at one sample, from its hulls, then its
//! solids. `rigid_pairs` decides pairs whose relative pose a constraint keeps, by one query per motion. `scratch` holds the
//! buffers of all collision queries, among them the hints that `pair_at_sample` keeps per pair. The folders `discrete` and
//! `continuous` drive these queries.

pub(crate) mod pair_at_sample;
pub(crate) mod rigid_pairs;
pub(crate) mod scratch;
pub mod settings;
