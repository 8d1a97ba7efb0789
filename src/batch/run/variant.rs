//! One of several settings of a batch.

use foliate_systems::settings::SearchSettings;

/// Settings of searches, and how many threads each search uses.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Name, for rows and tables; empty where a batch has one.
    pub name: String,
    /// Settings of the search; the seed in them is not used.
    pub search: SearchSettings,
    /// Threads within one search. Answers do not depend on it, times do.
    pub threads: usize,
}

impl Variant {
    /// Settings on one thread.
    #[must_use]
    pub fn new(name: impl Into<String>, search: SearchSettings) -> Self {
        Self { name: name.into(), search, threads: 1 }
    }
}
