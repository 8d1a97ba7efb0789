//! What all solves of a batch share.

use crate::batch::improvement::measurement::Measurement;
use crate::batch::run::seeds::Seeds;
use foliate_systems::settings::SearchSettings;
use std::time::Duration;

/// What all solves of a batch share.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The seeds, both ends included.
    pub seeds: Seeds,
    /// Threads of all solves that run at once. Each solve uses one, unless a [`Variant`](crate::batch::Variant) says otherwise.
    pub threads: usize,
    /// Wall time after which one solve gives up. The time that its problem took to load, once for all its solves, counts for each.
    pub time_limit: Duration,
    /// Settings of every search; the seed in them is not used.
    pub search: SearchSettings,
    /// How first paths are improved and looked at; `None` to end with the first path. The time limit holds for search and improvement
    /// together.
    pub improvement: Option<Measurement>,
}
