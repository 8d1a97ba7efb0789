//! A batch: problems, and with which schedulers, settings and seeds each is solved; which rows that makes.

use crate::batch::entry::{Entry, as_file_name};
use crate::batch::error::{BatchError, MOST_SOLVES};
use crate::batch::improvement::summary::{BestDurations, ImprovementTable};
use crate::batch::machine::{Machine, today};
use crate::batch::results::identity::{Identity, fingerprint};
use crate::batch::results::record::{FailureFolder, MOST_FAILURES};
use crate::batch::results::row::Row;
use crate::batch::results::table::{GroupSummary, SceneSummary, Table};
use crate::batch::run::cases::{Case, Cases, identity};
use crate::batch::run::settings::Settings;
use crate::batch::run::shard::Shard;
use crate::batch::run::variant::Variant;
use crate::batch::vary::options::Vary;
use crate::batch::vary::rejections::Rejections;
use crate::batch::vary::variations::Variations;
use crate::os::memory::MemoryLimit;
use crate::scene::sources::package::PackagePath;
use foliate_schedulers::Scheduler;
use foliate_systems::events::CancelToken;
use std::collections::{BTreeMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Problems, and with which schedulers, settings and seeds each is solved.
pub struct Batch {
    pub(super) entries: Vec<Entry>,
    pub(super) settings: Settings,
    pub(super) schedulers: Vec<Arc<dyn Scheduler>>,
    pub(super) variants: Vec<Variant>,
    vary: Option<Vary>,
    /// By entry, where problems are varied.
    pub(super) variations: Vec<Variations>,
    shard: Option<Shard>,
    pub(super) keeps_paths: bool,
    pub(super) token: CancelToken,
    pub(super) memory_limit: Option<MemoryLimit>,
    best: BestDurations,
    pub(super) failures: Option<FailureFolder>,
    pub(super) progress: Option<Box<dyn Fn(Progress) + Send + Sync>>,
}

/// How far a batch is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Rows that are there, those of an earlier run included.
    pub done: usize,
    /// All rows of the batch, or of its part.
    pub all: usize,
    /// How long the rest takes, as far as the rows so far tell; `None` while there is no row of some of it.
    pub left: Option<Duration>,
}

impl Batch {
    /// A batch with the default scheduler.
    ///
    /// # Errors
    /// No scenes, two of one name, or more than a million solves.
    pub fn new(entries: Vec<Entry>, settings: Settings) -> Result<Self, BatchError> {
        if entries.is_empty() {
            return Err(BatchError::Empty);
        }
        if let Some(name) = twice(entries.iter().map(Entry::file_stem)) {
            return Err(BatchError::SameName(name));
        }
        let variants = vec![Variant::new("", settings.search.clone())];
        let batch = Self {
            entries,
            settings,
            schedulers: vec![foliate_schedulers::default_scheduler().into()],
            variants,
            vary: None,
            variations: Vec::new(),
            shard: None,
            keeps_paths: true,
            token: CancelToken::default(),
            memory_limit: None,
            best: BestDurations::default(),
            failures: None,
            progress: None,
        };
        batch.within_most()
    }

    fn within_most(self) -> Result<Self, BatchError> {
        let solves = self.cases().count();
        if solves > MOST_SOLVES { Err(BatchError::TooMany(solves)) } else { Ok(self) }
    }

    /// Uses another scheduler.
    #[must_use]
    pub fn scheduler(mut self, scheduler: Arc<dyn Scheduler>) -> Self {
        self.schedulers = vec![scheduler];
        self
    }

    /// Uses several schedulers, each for all problems and seeds.
    ///
    /// # Errors
    /// None, two of one name, or more than a million solves.
    pub fn schedulers(mut self, schedulers: Vec<Arc<dyn Scheduler>>) -> Result<Self, BatchError> {
        if schedulers.is_empty() {
            return Err(BatchError::NoScheduler);
        }
        if let Some(name) = twice(schedulers.iter().map(|scheduler| scheduler.name().to_owned())) {
            return Err(BatchError::SameScheduler(name));
        }
        self.schedulers = schedulers;
        self.within_most()
    }

    /// Uses several settings, each for all problems, schedulers and seeds, in place of those that all solves share.
    ///
    /// # Errors
    /// None, two of one name or that are the same, one that uses more threads than the batch has, or more than a million solves.
    pub fn variants(mut self, variants: Vec<Variant>) -> Result<Self, BatchError> {
        if variants.is_empty() {
            return Err(BatchError::NoSettings);
        }
        if let Some(name) = twice(variants.iter().map(|variant| as_file_name(&variant.name))) {
            return Err(BatchError::SameSettings(name));
        }
        let is_same = |a: &Variant, b: &Variant| (&a.search, a.threads) == (&b.search, b.threads);
        for (number, variant) in variants.iter().enumerate() {
            if let Some(same) = variants[..number].iter().find(|other| is_same(other, variant)) {
                return Err(BatchError::EqualSettings(same.name.clone(), variant.name.clone()));
            }
            if variant.threads > self.settings.threads.max(1) {
                let (name, threads) = (variant.name.clone(), variant.threads);
                return Err(BatchError::Oversubscribed { name, threads, all: self.settings.threads });
            }
        }
        self.variants = variants;
        self.within_most()
    }

    /// Solves varied instances of each problem in place of the problem itself. Models are read again where they vary, by `packages`.
    ///
    /// # Errors
    /// A problem that cannot be varied so, or more than a million solves.
    pub fn vary(mut self, vary: Vary, packages: &PackagePath) -> Result<Self, BatchError> {
        let of_entry = |entry: &Entry| Variations::new(entry, vary.clone(), packages);
        self.variations = self.entries.iter().map(of_entry).collect::<Result<_, _>>()?;
        self.vary = Some(vary);
        self.within_most()
    }

    /// Solves one of several parts.
    #[must_use]
    pub fn shard(mut self, shard: Shard) -> Self {
        self.shard = Some(shard);
        self
    }

    /// Writes no path files.
    #[must_use]
    pub fn without_paths(mut self) -> Self {
        self.keeps_paths = false;
        self
    }

    /// Lets a token end the batch: solves under way stop and have no row, no further ones begin.
    #[must_use]
    pub fn cancelled_by(mut self, token: CancelToken) -> Self {
        self.token = token;
        self
    }

    /// Bounds the memory of all solves together. Each may count its share; where the process has more than the limit all that
    /// run at that time end.
    #[must_use]
    pub fn memory_limit(mut self, limit: MemoryLimit) -> Self {
        self.memory_limit = Some(limit);
        self
    }

    /// Compares the improved paths with the shortest durations of other runs too: see [`BestDurations::read`].
    #[must_use]
    pub fn best(mut self, best: BestDurations) -> Self {
        self.best = best;
        self
    }

    /// Records solves that find no path, each in a file of the name of its path and the ending `.search`, in a folder, which is made where
    /// it is missing: the first hundred to end, each of at most 16 MiB. Solves are measured while they keep what a recording needs.
    #[must_use]
    pub fn record_failures(mut self, folder: PathBuf) -> Self {
        self.failures = Some(FailureFolder::new(folder));
        self
    }

    /// Calls a function after each row, from the thread that made it, and once in the beginning.
    #[must_use]
    pub fn on_progress(mut self, progress: impl Fn(Progress) + Send + Sync + 'static) -> Self {
        self.progress = Some(Box::new(progress));
        self
    }

    /// How many failed solves this batch has recorded, and how many there were; none where it was not asked to record.
    #[must_use]
    pub fn failures_recorded(&self) -> Option<(usize, usize)> {
        let failed = self.failures.as_ref()?.failed();
        Some((failed.min(MOST_FAILURES), failed))
    }

    /// The problems.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Number of solves, of the part where there are parts.
    #[must_use]
    pub fn solves(&self) -> usize {
        match self.shard {
            Some(_) => self.numbers(&self.ids()).len(),
            None => self.cases().count() as usize,
        }
    }

    pub(super) fn cases(&self) -> Cases {
        Cases {
            entries: self.entries.len(),
            schedulers: self.schedulers.len(),
            variants: self.variants.len(),
            instances: self.vary.as_ref().map(|vary| vary.instances),
            seeds: self.settings.seeds,
        }
    }

    /// Identities of all rows.
    pub(super) fn ids(&self) -> Vec<String> {
        let cases = self.cases();
        let problems: Vec<String> = self.entries.iter().map(fingerprint).collect();
        let searches: Vec<String> = self.variants.iter().map(search_text).collect();
        let vary = self.vary.as_ref().map(Vary::text).unwrap_or_default();
        let limit = format!("{:?}", self.settings.time_limit.as_secs_f64());
        let improvement = self.improvement_text();
        let id = |number: usize| {
            let case = cases.case(number);
            let instance = case.instance.map(|instance| instance.to_string()).unwrap_or_default();
            identity(&[
                ("version", env!("CARGO_PKG_VERSION")),
                ("problem", &problems[case.entry]),
                ("vary", &vary),
                ("instance", &instance),
                ("scheduler", self.schedulers[case.scheduler].name()),
                ("search", &searches[case.variant]),
                ("threads", &self.variants[case.variant].threads.to_string()),
                ("time_limit_s", &limit),
                ("improvement", &improvement),
                ("seed", &case.seed.to_string()),
            ])
        };
        (0..cases.count() as usize).map(id).collect()
    }

    /// Numbers of the solves of this part.
    pub(super) fn numbers(&self, ids: &[String]) -> Vec<usize> {
        (0..ids.len()).filter(|&number| self.shard.is_none_or(|shard| shard.has(&ids[number]))).collect()
    }

    /// The name of a solve's files, without ending: the scene, then of scheduler, settings and instance what the batch has several of, and
    /// the seed.
    pub(super) fn stem(&self, case: Case) -> String {
        let mut parts = vec![self.entries[case.entry].file_stem()];
        parts.extend((self.schedulers.len() > 1).then(|| as_file_name(self.schedulers[case.scheduler].name())));
        parts.extend((self.variants.len() > 1).then(|| as_file_name(&self.variants[case.variant].name)));
        parts.extend(case.instance.map(|instance| instance.to_string()));
        parts.push(case.seed.to_string());
        parts.join("-")
    }

    /// What decides the rows, for `settings.json`.
    pub(super) fn identity(&self) -> Identity {
        let settings = &self.settings;
        let mut identity = BTreeMap::new();
        let mut say = |name: &str, value: String| identity.insert(name.to_owned(), value);
        for entry in &self.entries {
            say(&format!("scene {}", entry.name()), fingerprint(entry));
        }
        for variant in &self.variants {
            let name = if variant.name.is_empty() { "search".into() } else { format!("settings {}", variant.name) };
            say(&name, search_text(variant));
        }
        say("version", env!("CARGO_PKG_VERSION").to_owned());
        say("scheduler", self.scheduler_names().join(" "));
        say("seeds", settings.seeds.to_string());
        say("time_limit_s", format!("{:?}", settings.time_limit.as_secs_f64()));
        say("improvement", self.improvement_text());
        if let Some(vary) = &self.vary {
            say("vary", vary.text());
            say("instances", vary.instances.to_string());
        }
        if let Some(shard) = self.shard {
            say("shard", shard.to_string());
        }
        Identity(identity)
    }

    fn scheduler_names(&self) -> Vec<&str> {
        self.schedulers.iter().map(|scheduler| scheduler.name()).collect()
    }

    fn improvement_text(&self) -> String {
        self.settings.improvement.as_ref().map_or_else(|| "none".into(), ToString::to_string)
    }

    /// The table of some rows of this batch.
    #[must_use]
    pub fn table(&self, rows: &[Row]) -> Table {
        let names: Vec<&str> = self.entries.iter().map(Entry::name).collect();
        let measurement = self.settings.improvement.as_ref();
        let mut refused = Rejections::default();
        // An instance is drawn once for each scheduler, settings and seed, and refused as often.
        let mut seen = HashSet::new();
        rows.iter().filter(|row| seen.insert((&row.scene, row.instance))).for_each(|row| refused.add_all(&row.refused));
        Table {
            machine: Machine::here(),
            date: today(),
            scheduler: self.scheduler_names().join(", "),
            search: self.settings.search.clone(),
            seeds: self.settings.seeds,
            threads: self.settings.threads,
            time_limit: self.settings.time_limit,
            scenes: names.iter().map(|name| SceneSummary::of(name, rows)).collect(),
            groups: self.groups(rows),
            instances: self.vary.as_ref().map(|vary| vary.instances),
            refused,
            improvement: measurement.map(|how| ImprovementTable::of(how, &names, rows, &self.best)),
        }
    }

    /// The summaries of scenes with each scheduler and all settings, where there are several.
    fn groups(&self, rows: &[Row]) -> Vec<GroupSummary> {
        if self.schedulers.len() * self.variants.len() == 1 {
            return Vec::new();
        }
        let mut groups = Vec::new();
        for entry in &self.entries {
            for scheduler in &self.schedulers {
                for variant in &self.variants {
                    groups.push(GroupSummary::of(entry.name(), scheduler.name(), &variant.name, rows));
                }
            }
        }
        groups
    }
}

/// What decides a search but its seed.
fn search_text(variant: &Variant) -> String {
    let search = format!("{:?}", variant.search.clone().with(|s| s.seed = 0));
    if variant.threads > 1 { format!("{search} threads {}", variant.threads) } else { search }
}

/// The first that comes a second time.
fn twice(names: impl Iterator<Item = String>) -> Option<String> {
    let mut seen = HashSet::new();
    names.into_iter().find(|name| !seen.insert(name.clone()))
}
