//! `foliate solve`: plan for a scene, say what was found, write the path.

use super::coverage::LeftOut;
use super::summary::{self, Loaded};
use super::{Ending, Refusal, interrupt, loading, print, print_json, say};
use foliate::components::outcome::SearchOutcome;
use foliate::kernels::lanes::Level;
use foliate::memory::MemoryLimit;
use foliate::path_file::{PathContext, save, write_path};
use foliate::scene::{PackagePath, Scene};
use foliate::systems::events::SearchEvent;
use foliate::systems::planning_model::ProblemTables;
use foliate::systems::schedulers;
use foliate::systems::settings::{SearchSettings, Selection};
use foliate::{Planner, Solution, output};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Plans a path for a scene and writes it
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A shipped scene's name, or a scene file
    scene: String,
    #[command(flatten)]
    pub(crate) search: SearchArguments,
    /// Write the path to this file
    #[arg(long, value_name = "PATH.json")]
    out: Option<PathBuf>,
    /// Say between which shapes the least clearance is, and where on the path
    #[arg(long)]
    clearance: bool,
    /// List every pair of collision shapes that is not tested, with the reason
    #[arg(long)]
    pairs: bool,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Options of every command that searches.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct SearchArguments {
    /// Seed of every random stream; same seed, same answer
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Search scheduler; the default is the best over all shipped scenes, a name that does not exist lists all
    #[arg(long, default_value = schedulers::DEFAULT, value_name = "NAME")]
    pub scheduler: String,
    /// Threads for the search; the answer does not depend on it
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=512))]
    pub threads: u16,
    #[command(flatten)]
    pub tuning: Tuning,
    /// Seconds after which to give up, reading included
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    pub time_limit: f64,
}

/// Settings of the search that a user may change; defaults serve every shipped scene.
#[derive(clap::Args, Clone, Copy, Debug)]
pub(crate) struct Tuning {
    /// Candidates per step; another number is another search
    #[arg(long, default_value_t = 16, value_name = "B", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub candidates: u16,
    /// How a node to extend is chosen
    #[arg(long, value_enum, default_value_t = SelectionRule::Guided, value_name = "RULE")]
    pub selection: SelectionRule,
    /// What `--simd` says, or the best that this machine has.
    #[arg(skip)]
    pub level: Level,
    /// What `--memory-limit` says, or its default.
    #[arg(skip)]
    pub memory: Option<MemoryLimit>,
    /// Motions that stay in their state are tried with their weight times this
    #[arg(long, default_value_t = SearchSettings::default().loop_weight, value_name = "W", value_parser = weight)]
    pub loop_weight: f64,
    /// Residual (m, rad) down to which projections step in single precision; 0 for never
    #[arg(long, default_value_t = SearchSettings::default().projection_single_until, value_name = "R", value_parser = weight)]
    pub single_until: f64,
}

/// A weight: finite and not negative.
fn weight(text: &str) -> Result<f64, String> {
    let weight = text.parse::<f64>().ok().filter(|weight| weight.is_finite() && *weight >= 0.0);
    weight.ok_or_else(|| String::from("not a number from 0 on"))
}

impl Tuning {
    pub(crate) fn settings(self, seed: u64) -> SearchSettings {
        SearchSettings {
            seed,
            candidates: usize::from(self.candidates),
            selection: self.selection.into(),
            level: self.level,
            loop_weight: self.loop_weight,
            projection_single_until: self.single_until,
            ..SearchSettings::default()
        }
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
        let planner = Planner::of_tables(tables).map_err(|e| Refusal(e.to_string()))?;
        let planner = planner.settings(self.tuning.settings(self.seed)).time_limit(self.deadline()?);
        let planner = planner.cancelled_by(interrupt::token());
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

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let started = Instant::now();
    if let Some(out) = &arguments.out {
        writable(out)?;
    }
    let limit = arguments.search.deadline()?;
    let (scene, tables) = match loading::scene(&arguments.scene, packages, limit)? {
        Ok(loaded) => loaded,
        Err(cut) => return cut.tell(&arguments.scene, started.elapsed(), arguments.json),
    };
    for warning in &scene.warnings {
        say(&format!("warning: {warning}\n"));
    }
    let load_time = started.elapsed();
    let left_out = LeftOut::of(&tables);
    if let Some(warning) = left_out.warning() {
        say(&format!("warning: {warning}\n"));
    }
    // The limit is that of everything, reading included.
    let planner = arguments.search.planner(tables)?.time_limit(limit.saturating_sub(load_time));
    let solution = solve(planner, &arguments.search, !arguments.json)?;
    let (planner, mut solution) = solution;
    // Once, for whoever reads the answer: no part of what a solve costs.
    let clearance = solution.measure_clearance().filter(|_| arguments.clearance);
    if let (Some(out), Some(_)) = (&arguments.out, &solution.path) {
        write(out, &scene, &planner, &solution, &arguments.search)?;
    }
    let left_out = arguments.pairs.then_some(&left_out);
    let loaded = Loaded { scene: &scene, load_time, clearance: clearance.as_ref(), left_out };
    if arguments.json {
        print_json(&summary::json(&loaded, &arguments.search, &solution))?;
    } else {
        print(&summary::text(&loaded, &solution));
    }
    ending(&solution.outcome)
}

/// Refuses a place where no path could be written before anything is searched.
pub(crate) fn writable(out: &Path) -> Result<(), Refusal> {
    output::check(out).map_err(|error| Refusal(format!("{}: {error}", out.display())))
}

/// How a command ends that searched.
pub(crate) fn ending(outcome: &SearchOutcome) -> Result<Ending, Refusal> {
    match outcome {
        SearchOutcome::Solved => Ok(Ending::Done),
        SearchOutcome::InfeasibleStart(why) => Err(Refusal(format!("infeasible_start: {why}"))),
        SearchOutcome::InfeasibleGoal(why) => Err(Refusal(format!("infeasible_goal: {why}"))),
        SearchOutcome::Cancelled => Ok(Ending::Interrupted),
        SearchOutcome::Timeout | SearchOutcome::StepLimit | SearchOutcome::MemoryLimit => Ok(Ending::Failed),
        SearchOutcome::Crashed(why) => {
            say(&format!("error: the search crashed, which is a bug: {}\n", why.escape_debug()));
            Ok(Ending::Failed)
        }
    }
}

/// Solves, with a progress line on a terminal.
pub(crate) fn solve(
    planner: Planner,
    arguments: &SearchArguments,
    progress: bool,
) -> Result<(Planner, Solution), Refusal> {
    let threads = usize::from(arguments.threads);
    let failed = |e: rayon::ThreadPoolBuildError| Refusal(format!("cannot start {threads} threads: {e}"));
    if !(progress && std::io::stderr().is_terminal()) {
        let solution = planner.solve_on(threads).map_err(failed)?;
        return Ok((planner, solution));
    }
    let (planner, events) = planner.events();
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
        bar.set_style(style);
    }
    let solution = std::thread::scope(|scope| {
        let watcher = scope.spawn(|| watch(&events, &bar));
        let solution = planner.solve_on(threads);
        bar.finish_and_clear();
        let _ended = watcher.join();
        solution
    });
    let solution = solution.map_err(failed)?;
    Ok((planner, solution))
}

/// Shows progress until the bar is finished.
fn watch(events: &crossbeam_channel::Receiver<SearchEvent>, bar: &ProgressBar) {
    while !bar.is_finished() {
        match events.recv_timeout(Duration::from_millis(100)) {
            Ok(SearchEvent::Progress { step, candidates, nodes, edges, leaves }) => {
                bar.set_message(format!(
                    "step {step}, {candidates} candidates, {nodes} nodes, {edges} edges, {leaves} leaves"
                ));
                bar.tick();
            }
            Ok(SearchEvent::Rejected { .. } | SearchEvent::Feedback(_) | SearchEvent::Solved { .. }) => {}
            Err(crossbeam_channel::RecvTimeoutError::Timeout) => bar.tick(),
            Err(crossbeam_channel::RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Writes the path file, with the models that live only in the program beside it.
pub(crate) fn write(
    out: &Path,
    scene: &Scene,
    planner: &Planner,
    solution: &Solution,
    arguments: &SearchArguments,
) -> Result<(), Refusal> {
    let Some(path) = &solution.path else { return Ok(()) };
    let models = save::model_names(scene, out).map_err(|e| Refusal(e.to_string()))?;
    let context = PathContext {
        problem: &planner.model().problem,
        graph: &solution.model.graph,
        models: &models,
        seed: arguments.seed,
        scheduler: &arguments.scheduler,
        simd: arguments.tuning.level.name(),
    };
    save::save(&write_path(&context, path), out).map_err(|e| Refusal(e.to_string()))
}
