//! The options of `bench`, and the suite that they say.

use crate::batch::improvement::{Budget, Measurement};
use crate::batch::{Seeds, Shard, Suite, Variant};
use crate::cli::commands::solve::arguments::{BudgetArguments, INTERNALS, Tuning, deadline, no_scheduler};
use crate::cli::console::print::Refusal;
use crate::kernels::lanes::Level;
use crate::schedulers;
use std::path::PathBuf;
use std::time::Duration;

/// Solves scenes for many seeds and tabulates times and nodes
///
/// Measures the time to the first certified path, without improvement and times. With --improve-time or --improve-work each first path is
/// improved and timed as `solve` does it; times of first paths are measured as before, and how good paths are after how much time is
/// tabulated and drawn.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Shipped scenes' names, or scene files
    #[arg(required_unless_present = "suite", value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// A suite file says scenes, schedulers, settings, seeds, limits and what varies, in place of these options
    #[arg(long, value_name = "SUITE.toml")]
    #[arg(conflicts_with_all = ["scenes", "seeds", "time_limit", "scheduler", "improve_work", "improve_time", "checkpoints"])]
    #[arg(conflicts_with_all = ["candidates", "selection", "loop_weight"])]
    pub suite: Option<PathBuf>,
    /// From A to B, both included: 1..20 are twenty seeds
    #[arg(long, default_value = "1..20", value_name = "A..B")]
    pub seeds: Seeds,
    /// Threads in all: so many solves run at once, each on one thread unless the settings of a suite say otherwise [default: 1, or what the
    /// suite says]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=512))]
    pub threads: Option<u16>,
    /// Seconds after which one solve gives up, improvement included. A scene is read once, and the time that this took counts for each
    /// of its solves; one that cannot be read within the limit ends the bench before anything is solved
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    pub time_limit: f64,
    /// Folder for results.csv, table.md and paths/, with an improvement also for improvement.csv, history.csv and plots/; a new one,
    /// unless --resume is given
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Search scheduler; the default is the best over all shipped scenes, a name that does not exist lists all
    #[arg(long, default_value = schedulers::DEFAULT, value_name = "NAME", hide = true, help_heading = INTERNALS)]
    pub scheduler: String,
    /// Solve the i-th of n parts only; which part a row is in follows from the row alone
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    /// Go on with a folder in which the same bench was begun: rows that are there are kept
    #[arg(long)]
    pub resume: bool,
    #[command(flatten)]
    pub budget: BudgetArguments,
    /// Seconds of improvement after which the path is looked at, beside the first path and the end; those within the budget count
    #[arg(long, value_name = "S,S,...", value_delimiter = ',', requires = "BudgetArguments", value_parser = seconds)]
    #[arg(default_values = ["0.1", "1", "10"])]
    pub checkpoints: Vec<Duration>,
    /// improvement.csv of another run: its shortest durations are known too
    #[arg(long, value_name = "FILE.csv")]
    pub best: Option<PathBuf>,
    /// Write no path files
    #[arg(long)]
    pub no_paths: bool,
    /// Write the rows as a log of OMPL's benchmarks too; with several scenes one for each, FILE-SCENE.log
    #[arg(long, value_name = "FILE.log")]
    pub ompl_log: Option<PathBuf>,
    /// Write a page with plots of the rows too
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// Record solves that find no path, under the name of their path in this folder; the first hundred to end
    #[arg(long, value_name = "DIR")]
    pub record_failures: Option<PathBuf>,
    #[command(flatten)]
    pub tuning: Tuning,
    /// One JSON object instead of text
    #[arg(long)]
    pub json: bool,
}

impl Arguments {
    /// What is to be solved: what the suite file says, or the other options.
    pub(crate) fn suite(&self) -> Result<Suite, Refusal> {
        let mut suite = match &self.suite {
            Some(file) => Suite::read(file)?,
            None => self.suite_of_options()?,
        };
        if let Some(threads) = self.threads {
            suite.threads = usize::from(threads);
        }
        suite.paths &= !self.no_paths;
        if self.tuning.level != Level::default() {
            suite.settings.iter_mut().for_each(|variant| variant.search.level = self.tuning.level);
        }
        if self.best.is_some() && suite.improvement.is_none() {
            return Err(Refusal("--best compares improved paths: give --improve-time or --improve-work".into()));
        }
        Ok(suite)
    }

    fn suite_of_options(&self) -> Result<Suite, Refusal> {
        schedulers::named(&self.scheduler).ok_or_else(|| no_scheduler(&self.scheduler))?;
        Ok(Suite {
            name: "bench".into(),
            scenes: self.scenes.clone(),
            schedulers: vec![self.scheduler.clone()],
            settings: vec![Variant::new("", self.tuning.settings(self.seeds.first()))],
            seeds: self.seeds,
            time_limit: deadline(self.time_limit)?,
            threads: 1,
            improvement: measurement(self)?,
            vary: None,
            paths: true,
        })
    }
}

/// A number of seconds.
fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.trim().parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    seconds.ok_or_else(|| String::from("not a number of seconds"))
}

/// What is spent on better paths, where that is asked for.
fn measurement(arguments: &Arguments) -> Result<Option<Measurement>, Refusal> {
    let Some(budget) = arguments.budget.budget()? else { return Ok(None) };
    let limit = arguments.time_limit;
    if matches!(budget, Budget::Time(time) if time.as_secs_f64() >= limit) {
        return Err(Refusal(format!(
            "--improve-time does not fit into --time-limit {limit}, which holds for the search too"
        )));
    }
    Ok(Some(Measurement::new(budget).checkpoints(arguments.checkpoints.iter().copied())))
}
