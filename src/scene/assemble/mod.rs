//! From a scene file to a problem.
//!
//! `load` reads the tables of a file in turn: parts by `parts`, pairs by `pairs`, the graph and its hands by `graph`, goals by `goal`, `suggest`
//! (places worth trying), `start_tolerance`, rate limits and cost by `timing`. Graph and goals read their constraints by
//! `constraints`; all of them read coordinates, frames and locked joints by `names`. `scene` is the result, and what is at
//! hand while it is made.

pub(crate) mod constraints;
pub(crate) mod goal;
pub(crate) mod graph;
pub(crate) mod load;
pub(crate) mod names;
pub(crate) mod pairs;
pub(crate) mod parts;
pub(crate) mod scene;
pub(crate) mod start_tolerance;
pub(crate) mod suggest;
pub(crate) mod timing;
