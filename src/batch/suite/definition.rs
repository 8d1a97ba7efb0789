//! What a suite file says, and the batch that it makes.

use crate::batch::entry::Entry;
use crate::batch::error::BatchError;
use crate::batch::improvement::measurement::Measurement;
use crate::batch::run::batch::Batch;
use crate::batch::run::seeds::Seeds;
use crate::batch::run::settings::Settings;
use crate::batch::run::variant::Variant;
use crate::batch::vary::options::Vary;
use crate::scene::sources::package::PackagePath;
use foliate_schedulers::Scheduler;
use std::sync::Arc;
use std::time::Duration;

/// Scenes, and how each is solved: what a suite file says. [`Suite::read`] reads one; `docs/batches.md` has its keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Suite {
    /// Its name.
    pub name: String,
    /// Shipped scenes by their names, and files.
    pub scenes: Vec<String>,
    /// Names of schedulers.
    pub schedulers: Vec<String>,
    /// Settings of searches.
    pub settings: Vec<Variant>,
    /// The seeds.
    pub seeds: Seeds,
    /// Wall time after which one solve gives up.
    pub time_limit: Duration,
    /// Threads of all solves that run at once.
    pub threads: usize,
    /// How first paths are improved and looked at; `None` to end with the first path.
    pub improvement: Option<Measurement>,
    /// How problems vary.
    pub vary: Option<Vary>,
    /// Whether paths are written.
    pub paths: bool,
}

impl Suite {
    /// The batch of its scenes, which were loaded in their order.
    ///
    /// # Errors
    /// As [`Batch::new`], [`Batch::schedulers`], [`Batch::variants`] and [`Batch::vary`].
    pub fn batch(&self, entries: Vec<Entry>, packages: &PackagePath) -> Result<Batch, BatchError> {
        let search = self.settings.first().map(|variant| variant.search.clone()).unwrap_or_default();
        let settings = Settings {
            seeds: self.seeds,
            threads: self.threads,
            time_limit: self.time_limit,
            search,
            improvement: self.improvement.clone(),
        };
        let named = |name: &String| {
            let known = foliate_schedulers::named(name).map(Arc::<dyn Scheduler>::from);
            known.ok_or_else(|| BatchError::UnknownScheduler(name.clone()))
        };
        let schedulers = self.schedulers.iter().map(named).collect::<Result<_, _>>()?;
        let batch = Batch::new(entries, settings)?.schedulers(schedulers)?.variants(self.settings.clone())?;
        let batch = match &self.vary {
            Some(vary) => batch.vary(vary.clone(), packages)?,
            None => batch,
        };
        Ok(if self.paths { batch } else { batch.without_paths() })
    }
}
