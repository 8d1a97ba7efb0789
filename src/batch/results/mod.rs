//! What a batch leaves: rows, and what is made of them.
//!
//! A `row` is one solve, in cells of `csv`. `record` writes rows to disk as they come, `kept` takes up what an earlier run has left, where
//! `identity` says that it is the same batch. `table` sums rows up, `ompl_log` writes them for the programs of OMPL.

pub(crate) mod csv;
pub(crate) mod identity;
pub(crate) mod kept;
pub(crate) mod ompl_log;
pub(crate) mod record;
pub(crate) mod row;
pub(crate) mod table;
