//! The verbs of Foliate: systems over the nouns of `foliate_components`, with the numbers of `foliate_kernels`.
#![forbid(unsafe_code)]

pub mod graph_building;
