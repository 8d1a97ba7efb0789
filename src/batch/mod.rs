//! Batches: the same problems over many seeds, one row each whatever happens.
//!
//! Solves are independent and single-threaded; [`Settings::threads`] says how many run side by side. A problem's model is
//! built once and shared. Every solve ends as one [`Row`]: an answer, a limit, or a panic, which is caught and takes no
//! other solve down. (What ends the whole process, such as a lack of memory, ends the batch; the rows written by then are on
//! disk.)
//!
//! `run` has each `entry` solved (`solve`) with each of the `seeds`, by its `settings`. `record` writes a `row` for each to disk, and
//! takes up what an earlier run left by `kept`. `table` sums the rows up; `machine` says where they were measured. `improvement`
//! looks at paths while they get better.

pub(crate) mod entry;
pub mod error;
pub mod improvement;
pub(crate) mod kept;
pub(crate) mod machine;
pub(crate) mod record;
pub(crate) mod row;
pub mod run;
pub(crate) mod seeds;
pub(crate) mod settings;
pub(crate) mod solve;
pub(crate) mod table;

pub use crate::batch::entry::Entry;
pub use crate::batch::error::BatchError;
pub use crate::batch::machine::{Machine, today};
pub use crate::batch::row::{COLUMNS, PathNumbers, Row, RowOutcome, Work};
pub use crate::batch::run::Batch;
pub use crate::batch::seeds::{Seeds, SeedsError};
pub use crate::batch::settings::Settings;
pub use crate::batch::table::{SceneSummary, Spread, Table};
