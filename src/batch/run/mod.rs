//! The run of a batch: which solves there are, in which order they are made, and what each does.
//!
//! `cases` numbers the solves of a batch and gives each the identity of its row; `shard` takes a part of them. `queue` hands them out, those
//! first that are expected to take longest, and `cores` lets as many run as there are threads. `solve` makes one; a `batch` says what all of
//! them are, `work` makes them. `settings`, `variant` and `seeds` are what they share. `pool` works for callers that take answers in order one by one, `stream` plans with it.

pub(crate) mod batch;
pub(crate) mod cases;
pub(crate) mod cores;
pub(crate) mod pool;
pub(crate) mod queue;
pub(crate) mod seeds;
pub(crate) mod settings;
pub(crate) mod shard;
pub(crate) mod solve;
pub(crate) mod stream;
pub(crate) mod variant;
pub(crate) mod work;
