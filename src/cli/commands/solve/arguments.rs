//! The options of every command that searches, and the planner that they make.

use crate::Planner;
use crate::batch::improvement::Budget;
use crate::cli::console::interrupt;
use crate::cli::console::print::Refusal;
use crate::kernels::lanes::Level;
use crate::memory::MemoryLimit;
use crate::schedulers;
use crate::systems::planning_model::ProblemTables;
use crate::systems::settings::{SearchSettings, Selection};
use std::sync::Arc;
use std::time::Duration;

/// Heading of options that change how a search works: `--help-search` alone shows them.
pub(crate) const INTERNALS: &str = "Options of the search itself";

/// Options of every command that searches.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct SearchArguments {
    /// Seconds after which to give up, reading included
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    pub time_limit: f64,
    #[command(flatten)]
    pub refinement: RefinementArguments,
    /// Seed of every random stream; same seed, same answer
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads for the search; the answer does not depend on it
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=512))]
    pub threads: u16,
    /// Search scheduler; the default is the best over all shipped scenes, a name that does not exist lists all
    #[arg(long, default_value = schedulers::DEFAULT, value_name = "NAME", hide = true, help_heading = INTERNALS)]
    pub scheduler: String,
    #[command(flatten)]
    pub tuning: Tuning,
}

/// What becomes of the first path.
#[derive(clap::Args, Clone, Copy, Debug)]
pub(crate) struct RefinementArguments {
    /// Answer with the first path: no improvement, no times
    #[arg(long, conflicts_with = "BudgetArguments")]
    pub first: bool,
    #[command(flatten)]
    pub budget: BudgetArguments,
}

/// How much is spent on a better path than the first.
#[derive(clap::Args, Clone, Copy, Debug)]
pub(crate) struct BudgetArguments {
    /// Counted work to spend on a better path; the answer does not depend on threads or machine
    #[arg(long, value_name = "N", conflicts_with = "improve_time")]
    pub improve_work: Option<u64>,
    /// Seconds to spend on a better path instead; the summary tells the work that gives the same path again
    #[arg(long, value_name = "S")]
    pub improve_time: Option<f64>,
}

impl RefinementArguments {
    fn apply(self, planner: Planner) -> Result<Planner, Refusal> {
        let planner = if self.first { planner.first_path() } else { planner };
        Ok(match self.budget.budget()? {
            Some(Budget::Work(work)) => planner.improve_work(work),
            Some(Budget::Time(time)) => planner.improve_time(time),
            None => planner,
        })
    }
}

impl BudgetArguments {
    /// The budget that is asked for, where there is one.
    pub(crate) fn budget(self) -> Result<Option<Budget>, Refusal> {
        let Some(seconds) = self.improve_time else { return Ok(self.improve_work.map(Budget::Work)) };
        let time = Duration::try_from_secs_f64(seconds)
            .map_err(|_| Refusal(format!("--improve-time {seconds} is not a number of seconds")))?;
        Ok(Some(Budget::Time(time)))
    }
}

/// Settings of the search that a user may change; defaults serve every shipped scene.
#[derive(clap::Args, Clone, Copy, Debug)]
pub(crate) struct Tuning {
    /// Candidates per step; another number is another search
    #[arg(long, default_value_t = 16, value_name = "B", value_parser = clap::value_parser!(u16).range(1..=4096))]
    #[arg(hide = true, help_heading = INTERNALS)]
    pub candidates: u16,
    /// How a node to extend is chosen
    #[arg(long, value_enum, default_value_t = SelectionRule::Guided, value_name = "RULE")]
    #[arg(hide = true, help_heading = INTERNALS)]
    pub selection: SelectionRule,
    /// What `--simd` says, or the best that this machine has.
    #[arg(skip)]
    pub level: Level,
    /// What `--memory-limit` says, or its default.
    #[arg(skip)]
    pub memory: Option<MemoryLimit>,
    /// Motions that stay in their state are tried with their weight times this
    #[arg(long, default_value_t = SearchSettings::default().loop_weight, value_name = "W", value_parser = weight)]
    #[arg(hide = true, help_heading = INTERNALS)]
    pub loop_weight: f64,
    /// Print the options that change how the search works, and exit
    #[arg(long = "help-search")]
    _help: bool,
}

/// A weight: finite and not negative.
fn weight(text: &str) -> Result<f64, String> {
    let weight = text.parse::<f64>().ok().filter(|weight| weight.is_finite() && *weight >= 0.0);
    weight.ok_or_else(|| String::from("not a number from 0 on"))
}

impl Tuning {
    pub(crate) fn settings(self, seed: u64) -> SearchSettings {
        SearchSettings::default().with(|s| {
            s.seed = seed;
            s.candidates = usize::from(self.candidates);
            s.selection = self.selection.into();
            s.level = self.level;
            s.loop_weight = self.loop_weight;
        })
    }
}

/// [`Selection`] on the command line.
#[derive(clap::ValueEnum, Clone, Copy, Debug)]
pub(crate) enum SelectionRule {
    /// Half of the candidates towards what other trees have reached, the others as leaf-first
    Guided,
    /// A tree, one of its leaves, the nearest node on it
    LeafFirst,
    /// A tree, one of its states, the nearest node in it
    StateFirst,
    /// The nearest node of the whole roadmap
    Nearest,
}

impl From<SelectionRule> for Selection {
    fn from(rule: SelectionRule) -> Self {
        match rule {
            SelectionRule::Guided => Self::Guided,
            SelectionRule::LeafFirst => Self::LeafFirst,
            SelectionRule::StateFirst => Self::StateFirst,
            SelectionRule::Nearest => Self::Nearest,
        }
    }
}

impl SearchArguments {
    /// The time limit, where it is a number of seconds.
    pub(crate) fn deadline(&self) -> Result<Duration, Refusal> {
        deadline(self.time_limit)
    }

    /// A planner for a problem.
    pub(crate) fn planner(&self, tables: Arc<ProblemTables>) -> Result<Planner, Refusal> {
        let planner = Planner::from_tables(tables).map_err(|e| Refusal(e.to_string()))?;
        let planner = planner.settings(self.tuning.settings(self.seed)).time_limit(self.deadline()?);
        let planner = self.refinement.apply(planner.cancelled_by(interrupt::token()))?;
        let planner = match self.tuning.memory {
            Some(limit) => planner.memory_limit(limit),
            None => planner,
        };
        planner.scheduler_named(&self.scheduler).ok_or_else(|| no_scheduler(&self.scheduler))
    }
}

/// A time limit, where it is a number of seconds.
pub(crate) fn deadline(seconds: f64) -> Result<Duration, Refusal> {
    Duration::try_from_secs_f64(seconds)
        .map_err(|_| Refusal(format!("--time-limit {seconds} is not a number of seconds")))
}

/// Says which schedulers there are.
pub(crate) fn no_scheduler(name: &str) -> Refusal {
    let known: Vec<_> = schedulers::shipped().iter().map(|s| s.name()).collect();
    Refusal(format!("there is no scheduler `{}`; known: {}", name.escape_debug(), known.join(", ")))
}
