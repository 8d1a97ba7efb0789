//! Runs `foliate solve`: reads the scene, searches, prints the summary, saves the path.

use crate::cli::commands::solve::answer::Answer;
use crate::cli::commands::solve::arguments::SearchArguments;
use crate::cli::commands::solve::coverage::LeftOut;
use crate::cli::commands::solve::record::RecordArguments;
use crate::cli::commands::solve::summary::Loaded;
use crate::cli::commands::solve::{summary, summary_json};
use crate::cli::commands::view::answered::ViewArguments;
use crate::cli::console::loading;
use crate::cli::console::outputs;
use crate::cli::console::print::{Ending, Refusal, print, print_json, say};
use crate::scene::{PackagePath, Scene, StartFile};
use crate::systems::events::{SearchEvent, SolveEvent};
use crate::{NoSolution, NoSolutionReason, ObjectTries, Planner, Solution};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Plans a path for a scene and writes it
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A shipped scene's name, or a scene file
    scene: String,
    /// Write the path to this file
    #[arg(long, value_name = "PATH.json")]
    out: Option<PathBuf>,
    /// Start where this file says: names of joints and parts to values and poses; what it leaves out starts as in the scene
    #[arg(long, value_name = "START.json")]
    start: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) search: SearchArguments,
    #[command(flatten)]
    record: RecordArguments,
    #[command(flatten)]
    view: ViewArguments,
    /// Print between which shapes the least clearance is, and where on the path
    #[arg(long)]
    clearance: bool,
    /// List every pair of collision shapes that is not tested, with the reason
    #[arg(long)]
    pairs: bool,
    /// Also print counters of the search, and what became of the candidates of each transition
    #[arg(long)]
    verbose: bool,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let started = Instant::now();
    outputs::check(
        [&*arguments.scene].into_iter().chain(arguments.start.as_deref().and_then(Path::to_str)),
        arguments.out.iter().chain(&arguments.record.record).chain(arguments.view.file()),
    )?;
    let limit = arguments.search.deadline()?;
    let start = arguments.start.as_deref().map(StartFile::read).transpose()?;
    let (scene, tables) = match loading::scene(&arguments.scene, packages, limit, start)? {
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
    let planner = arguments.record.apply(planner);
    for snapped in &planner.model().snapped {
        say(&format!("warning: {snapped}\n"));
    }
    let (planner, mut answer) = solve(planner, &arguments.search, !arguments.json)?;
    // Once, for the reader of the answer: no part of the cost of a solve.
    let clearance = answer.measure_clearance().filter(|_| arguments.clearance);
    if let (Some(out), Ok(solution)) = (&arguments.out, &answer.0) {
        write(out, &scene, solution, &arguments.search)?;
    }
    arguments.record.write(&scene, &planner, &answer, &arguments.search)?;
    let left_out = arguments.pairs.then_some(&left_out);
    let verbose = arguments.verbose;
    let loaded = Loaded { scene: &scene, load_time, clearance: clearance.as_ref(), left_out, verbose };
    if arguments.json {
        print_json(&summary_json::json(&loaded, &arguments.search, &answer))?;
    } else {
        print(&summary::text(&loaded, &answer));
    }
    // What a program reads is one object.
    let tell = if arguments.json { say } else { print };
    arguments.view.write(&scene, &answer, (packages, tell));
    ending(&answer)
}

/// How a command ends that searched.
pub(crate) fn ending(answer: &Answer) -> Result<Ending, Refusal> {
    let Some(reason) = answer.reason() else { return Ok(Ending::Done) };
    match reason {
        NoSolutionReason::InfeasibleStart(why) | NoSolutionReason::InfeasibleGoal(why) => {
            Err(Refusal(format!("{}: {why}", reason.name())))
        }
        NoSolutionReason::Cancelled => Ok(Ending::Interrupted),
        NoSolutionReason::Crashed(_) | NoSolutionReason::NoPath => {
            say(&format!("error: {reason}\n"));
            Ok(Ending::Failed)
        }
        _ => Ok(Ending::Failed),
    }
}

/// Solves, with a progress line on a terminal.
pub(crate) fn solve(
    planner: Planner,
    arguments: &SearchArguments,
    progress: bool,
) -> Result<(Planner, Answer), Refusal> {
    let threads = usize::from(arguments.threads);
    let bar = ProgressBar::new_spinner();
    let above = bar.clone();
    let planner = planner.on_likely_impossible(move |rows| above.suspend(|| rows.iter().for_each(doubt)));
    if !(progress && std::io::stderr().is_terminal()) {
        bar.set_draw_target(ProgressDrawTarget::hidden());
        let answer = begun(planner.solve_on(threads))?;
        return Ok((planner, answer));
    }
    let (planner, events) = planner.events();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
        bar.set_style(style);
    }
    let answer = std::thread::scope(|scope| {
        let watcher = scope.spawn(|| watch(&events, &bar));
        let answer = planner.solve_on(threads);
        bar.finish_and_clear();
        let _ended = watcher.join();
        answer
    });
    Ok((planner, begun(answer)?))
}

/// Says why an object likely cannot be moved, while the search goes on.
fn doubt(row: &ObjectTries) {
    for reason in row.reasons() {
        say(&format!("note: {reason}. The search goes on\n"));
    }
}

/// Refuses a solve that did not begin, since there are no threads for it.
fn begun(answer: Result<Solution, NoSolution>) -> Result<Answer, Refusal> {
    match answer {
        Err(NoSolution { reason: reason @ NoSolutionReason::Threads { .. }, .. }) => Err(Refusal(reason.to_string())),
        answer => Ok(Answer(answer)),
    }
}

/// Shows progress until the bar is finished.
fn watch(events: &crate::crossbeam_channel::Receiver<SolveEvent>, bar: &ProgressBar) {
    while !bar.is_finished() {
        match events.recv_timeout(Duration::from_millis(100)).map(|told| told.event) {
            Ok(SearchEvent::Progress { step, candidates, nodes, edges, leaves }) => {
                bar.set_message(format!(
                    "step {step}, {candidates} candidates, {nodes} nodes, {edges} edges, {leaves} leaves"
                ));
                bar.tick();
            }
            Ok(_) => {}
            Err(crate::crossbeam_channel::RecvTimeoutError::Timeout) => bar.tick(),
            Err(crate::crossbeam_channel::RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Writes the path file, with the models that live only in the program beside it.
pub(crate) fn write(
    out: &Path,
    scene: &Scene,
    solution: &Solution,
    arguments: &SearchArguments,
) -> Result<(), Refusal> {
    let search = (arguments.seed, arguments.scheduler.as_str(), arguments.tuning.level);
    solution.save(scene, search, out).map_err(|e| Refusal(e.to_string()))
}
