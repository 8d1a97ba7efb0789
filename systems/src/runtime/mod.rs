//! What systems need of the machine and of random numbers, whatever they compute: nothing here knows of planning.
//!
//! `parallel` shares work among the threads of the pool, `watch` keeps the idle ones awake while a search runs. `random`
//! gives each candidate its own stream, `scratch_pool` lends buffers between steps, `system_sequence` runs several systems as
//! one.

pub mod parallel;
pub mod random;
pub mod scratch_pool;
pub mod system_sequence;
pub(crate) mod watch;
