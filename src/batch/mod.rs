//! Batches: the same problems over many seeds, one row each whatever happens.
//!
//! Solves are independent and single-threaded; [`Settings::threads`] says how many run side by side. A problem's model is
//! built once and shared. Every solve ends as one [`Row`]: an answer, a limit, or a panic, which is caught and takes no
//! other solve down. (What ends the whole process, such as a lack of memory, ends the batch; the rows written by then are on
//! disk.)
//!
//! A `suite` file says what a batch is; an `entry` is one of its problems, of which `vary` makes instances. `run` solves all of them, and
//! `results` are the rows, on disk and in tables; `machine` says where they were measured. `improvement` looks at paths while they get
//! better, `report` draws what rows say.

pub(crate) mod entry;
pub(crate) mod error;
pub mod improvement;
pub(crate) mod machine;
#[cfg(feature = "report")]
pub mod report;
pub(crate) mod results;
pub(crate) mod run;
pub(crate) mod suite;
pub mod vary;

pub use crate::batch::entry::Entry;
pub use crate::batch::error::BatchError;
pub use crate::batch::machine::{Machine, today};
pub use crate::batch::results::ompl_log::write_ompl_log;
pub use crate::batch::results::row::{COLUMNS, PathNumbers, Row, RowOutcome, Work};
pub use crate::batch::results::table::{GroupSummary, SceneSummary, Spread, Table};
pub use crate::batch::run::batch::{Batch, Progress};
pub use crate::batch::run::pool::Pool;
pub use crate::batch::run::seeds::{Seeds, SeedsError};
pub use crate::batch::run::settings::Settings;
pub use crate::batch::run::shard::{Shard, ShardError};
pub use crate::batch::run::stream::{PlanBatch, plan_batch};
pub use crate::batch::run::variant::Variant;
pub use crate::batch::suite::definition::Suite;
