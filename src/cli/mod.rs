//! The commands, one file each. Exit codes: 0 done, 1 no solution or a check that fails, 2 wrong usage or input, or output
//! that could not be written, 3 proved only relative to what a file says of itself, 4 undecided within limits, 130 interrupted.

mod bench;
mod certify;
mod check;
mod coverage;
mod demo;
mod graph;
mod inspect;
mod interrupt;
mod loading;
mod models;
mod processor_time;
mod scenes;
mod solve;
mod story;
mod summary;
mod watchdog;

use clap::{Parser, Subcommand};
use foliate::kernels::lanes::Level;
use foliate::memory::MemoryLimit;
use foliate::scene::{MeshCache, PackagePath, SceneError};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::OnceLock;

/// Plans manipulation: grasp, carry, regrasp, hand over, put down.
#[derive(Parser)]
#[command(name = "foliate", version, arg_required_else_help = true)]
struct Cli {
    /// Directory that holds packages, for package:// URLs; may be given several times
    #[arg(long, global = true, value_name = "DIR")]
    package_path: Vec<PathBuf>,
    /// Neither read nor keep meshes in the mesh cache (FOLIATE_MESH_CACHE, or foliate/meshes in the user's cache directory);
    /// answers are the same, loading takes longer
    #[arg(long, global = true)]
    no_mesh_cache: bool,
    /// SIMD level of the arithmetic, instead of the best that this machine has; results are equal bit for bit only at one
    /// level
    #[arg(long, global = true, value_name = "LEVEL", value_parser = Level::named)]
    simd: Option<Level>,
    /// Most memory of the process: bytes, or a number with MB, GB, MiB or GiB; a search ends with outcome memory_limit before it, and
    /// reading ends with an error. Default: three quarters of what the machine or its container has, at most 16 GiB
    #[arg(long, global = true, value_name = "SIZE")]
    memory_limit: Option<MemoryLimit>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Demo(demo::Arguments),
    Solve(solve::Arguments),
    Certify(certify::Arguments),
    Check(check::Arguments),
    Graph(graph::Arguments),
    Bench(bench::Arguments),
    Inspect(inspect::Arguments),
    Models(models::Arguments),
    Scenes(scenes::Arguments),
}

impl Command {
    /// Bounds the memory of a command that searches.
    fn bound(&mut self, limit: MemoryLimit) {
        match self {
            Self::Demo(arguments) => arguments.search.tuning.memory = Some(limit),
            Self::Solve(arguments) => arguments.search.tuning.memory = Some(limit),
            Self::Bench(arguments) => arguments.tuning.memory = Some(limit),
            // These do not search.
            Self::Certify(_)
            | Self::Check(_)
            | Self::Graph(_)
            | Self::Inspect(_)
            | Self::Models(_)
            | Self::Scenes(_) => {}
        }
    }

    /// Makes a command that searches do so at a level.
    fn force(&mut self, level: Level) {
        match self {
            Self::Demo(arguments) => arguments.search.tuning.level = level,
            Self::Solve(arguments) => arguments.search.tuning.level = level,
            Self::Bench(arguments) => arguments.tuning.level = level,
            Self::Certify(arguments) => arguments.level = level,
            // These do not search.
            Self::Check(_) | Self::Graph(_) | Self::Inspect(_) | Self::Models(_) | Self::Scenes(_) => {}
        }
    }
}

/// How a command ended that did what it was asked.
pub(crate) enum Ending {
    /// Exit code 0.
    Done,
    /// Exit code 1: no solution within limits, a check that fails, something that is not there.
    Failed,
    /// Exit code 3: what is proved holds only relative to what a file says of itself.
    Relative,
    /// Exit code 4: undecided within the limits of work, time or resolution.
    Undecided,
    /// Exit code 130: a signal has stopped it.
    Interrupted,
}

/// Why a command did not do what it was asked: exit code 2, and what is said on standard error.
pub(crate) struct Refusal(pub String);

impl From<SceneError> for Refusal {
    fn from(error: SceneError) -> Self {
        Self(error.to_string())
    }
}

/// Reads the command line, runs the command, tells how it ended.
pub(crate) fn main() -> ExitCode {
    interrupt::survive_size_limits();
    let code = match Cli::try_parse() {
        Ok(cli) => run(cli),
        Err(told) => {
            if let Err(error) = told.print() {
                lose(error);
            }
            told.exit_code() as u8
        }
    };
    if let Err(error) = std::io::stdout().flush() {
        lose(error);
    }
    match LOST.get() {
        Some(error) => {
            say(&format!("error: standard output: {error}\n"));
            ExitCode::from(2)
        }
        None => ExitCode::from(code),
    }
}

fn run(mut cli: Cli) -> u8 {
    if let Some(level) = cli.simd {
        cli.command.force(level);
    }
    let limit = cli.memory_limit.unwrap_or_else(MemoryLimit::of_machine);
    cli.command.bound(limit);
    watchdog::start(limit);
    let mesh_cache = if cli.no_mesh_cache { None } else { MeshCache::of_user() };
    let packages = PackagePath::from_environment(&cli.package_path).with_mesh_cache(mesh_cache);
    let ending = match &cli.command {
        Command::Demo(arguments) => demo::run(arguments, &packages),
        Command::Solve(arguments) => solve::run(arguments, &packages),
        Command::Certify(arguments) => certify::run(arguments, &packages),
        Command::Check(arguments) => check::run(arguments, &packages),
        Command::Bench(arguments) => bench::run(arguments, &packages),
        Command::Graph(arguments) => graph::run(arguments, &packages),
        Command::Inspect(arguments) => inspect::run(arguments, &packages),
        Command::Models(arguments) => models::run(arguments, &packages),
        Command::Scenes(arguments) => scenes::run(arguments),
    };
    match ending {
        Ok(Ending::Done) => 0,
        Ok(Ending::Failed) => 1,
        Ok(Ending::Relative) => 3,
        Ok(Ending::Undecided) => 4,
        Ok(Ending::Interrupted) => interrupt::EXIT_CODE,
        Err(Refusal(message)) => {
            say(&format!("error: {message}\n"));
            2
        }
    }
}

/// Why output was lost, once it was: no command may end as if it had told what it found.
static LOST: OnceLock<std::io::Error> = OnceLock::new();

/// A reader that has gone away has read what it wanted; the verdict stands, and so does the exit code.
fn lose(error: std::io::Error) {
    if error.kind() != std::io::ErrorKind::BrokenPipe {
        let _the_first_is_told = LOST.set(error);
    }
}

/// Writes to standard output. What cannot be written makes the program end with exit code 2, see [`main`].
pub(crate) fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        lose(error);
    }
}

/// Writes to standard error.
pub(crate) fn say(text: &str) {
    let _gone = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Writes an object as one line of JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Refusal> {
    let text = serde_json::to_string(value).map_err(|e| Refusal(format!("cannot write JSON: {e}")))?;
    print(&format!("{text}\n"));
    Ok(())
}
