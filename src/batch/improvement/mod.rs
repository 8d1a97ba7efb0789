//! Paths that a batch improves, and what they are like over time.
//!
//! A `measurement` says how much is spent and when paths are looked at. `watch` keeps the paths of one solve and makes each a
//! `checkpoint`; `numbers` are what its row has of them. `files` writes and reads them. `summary` sums them up over seeds and scenes,
//! `plots` draws them with `chart` and `curve`; `quantile` serves both.

pub(crate) mod chart;
pub(crate) mod checkpoint;
pub(crate) mod curve;
pub(crate) mod files;
pub(crate) mod measurement;
pub(crate) mod numbers;
pub(crate) mod plots;
pub(crate) mod quantile;
pub(crate) mod summary;
pub(crate) mod watch;

pub use crate::batch::improvement::checkpoint::{CHECKPOINT_COLUMNS, Checkpoint, HISTORY_COLUMNS};
pub use crate::batch::improvement::measurement::{Budget, Measurement};
pub use crate::batch::improvement::numbers::{AnswerNumbers, ImprovementNumbers};
pub use crate::batch::improvement::summary::{BestDurations, ImprovementTable, Moment, SceneImprovement};
