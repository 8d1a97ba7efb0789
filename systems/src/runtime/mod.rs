//! TODO(page): what lies in runtime.

pub mod idle_tasks;
pub(crate) mod parallel;
pub mod random;
pub mod scratch_pool;
pub mod system_sequence;
