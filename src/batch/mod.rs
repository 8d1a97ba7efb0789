//! TODO(page): what lies in batch.

pub(crate) mod entry;
pub mod error;
pub(crate) mod kept;
pub(crate) mod machine;
pub(crate) mod record;
pub(crate) mod row;
pub mod run;
pub(crate) mod seeds;
pub(crate) mod table;

pub use crate::batch::entry::Entry;
pub use crate::batch::error::BatchError;
pub use crate::batch::machine::{Machine, today};
pub use crate::batch::row::{COLUMNS, PathNumbers, Row, RowOutcome, Work};
pub use crate::batch::run::{Batch, Settings};
pub use crate::batch::seeds::{Seeds, SeedsError};
pub use crate::batch::table::{SceneSummary, Spread, Table};
