//! Recordings of searches: `"format": "foliate.search/1"`, what was searched, what the search did, and where it got stuck.
//!
//! A recording is what is left of a search once its world is gone, found or not: [`Recording::of`] an answer of a planner that was asked to
//! record. A page can be made of it and of the models that it names (`docs/recording-file.md`).
//!
//! `document` is the form of the head of a file, `make` fills it from an answer: `graph_rows` with states and transitions, `funnel_rows` with what became
//! of candidates, `findings` with what is wrong with a start or goal. `columns` has the numbers behind the head, `write` and `read` the files, with `error`.
//! `shown` is what a page shows of it, `words` the same in sentences.

pub(crate) mod columns;
pub(crate) mod document;
pub(crate) mod error;
pub(crate) mod findings;
pub(crate) mod funnel_rows;
pub(crate) mod graph_rows;
pub(crate) mod make;
pub(crate) mod read;
pub(crate) mod shown;
pub(crate) mod words;
pub(crate) mod write;

pub use crate::planner::recording::document::{
    BlockedPairEntry, CountsEntry, FORMAT, FindingEntry, FunnelEntry, GoalSearchEntry, LeftOutEntry, MemberEntry,
    MisplacedEntry, Recording, RecordingHead, RejectionEntry, RootsEntry, StateEntry, TransitionEntry,
};
pub use crate::planner::recording::error::RecordingError;
pub use crate::planner::recording::shown::{ShownFunnel, ShownPair, ShownSearch, TreeJoin};
