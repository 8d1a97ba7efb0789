//! The arguments of the program, the choice of the command, and the exit code.

use crate::cli::commands::bench;
use crate::cli::commands::models::install;
use crate::cli::commands::solve::arguments::INTERNALS;
use crate::cli::commands::solve::run;
use crate::cli::commands::{check, demo, export, graph, new, scenes};
use crate::cli::console::print::{Ending, LOST, Refusal, lose, print, say};
use crate::cli::console::{interrupt, watchdog};
use crate::kernels::lanes::Level;
use crate::memory::MemoryLimit;
use crate::scene::{MeshCache, PackagePath, XacroUse};
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

/// Plans manipulation: grasp, carry, regrasp, hand over, put down.
#[derive(Parser)]
#[command(name = "foliate", version, arg_required_else_help = true)]
struct Cli {
    /// Directory that holds packages, for package:// URLs, and below which models may name meshes; may be given several times
    #[arg(long, global = true, value_name = "DIR")]
    package_path: Vec<PathBuf>,
    /// Neither read nor keep meshes in the mesh cache (FOLIATE_MESH_CACHE, or foliate/meshes in the user's cache directory);
    /// answers are the same, loading takes longer
    #[arg(long, global = true)]
    no_mesh_cache: bool,
    /// Which xacro files the program `xacro` may expand, where it is installed (it evaluates what is written in them): those that you or
    /// a scene name (models), also those that path files name (always), or none (never)
    #[arg(long, global = true, value_name = "WHICH", default_value = "models", value_parser = ["models", "always", "never"])]
    xacro: String,
    /// SIMD level of the arithmetic, instead of the best that this machine has; results are equal bit for bit only at one
    /// level
    #[arg(long, global = true, value_name = "LEVEL", value_parser = Level::named)]
    #[arg(hide = true, help_heading = INTERNALS)]
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
    Solve(run::Arguments),
    Certify(crate::cli::commands::certify::run::Arguments),
    Check(check::Arguments),
    Export(export::Arguments),
    Graph(graph::Arguments),
    Bench(bench::arguments::Arguments),
    Inspect(crate::cli::commands::inspect::run::Arguments),
    Models(install::Arguments),
    New(new::Arguments),
    Scenes(scenes::Arguments),
    View(crate::cli::commands::view::run::Arguments),
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
            | Self::Export(_)
            | Self::Graph(_)
            | Self::Inspect(_)
            | Self::Models(_)
            | Self::New(_)
            | Self::Scenes(_)
            | Self::View(_) => {}
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
            Self::Check(_)
            | Self::Export(_)
            | Self::Graph(_)
            | Self::Inspect(_)
            | Self::Models(_)
            | Self::New(_)
            | Self::Scenes(_)
            | Self::View(_) => {}
        }
    }
}

/// Runs the program `foliate` with arguments, of which the first is its name: what is asked for is printed, how it ended is the exit code.
///
/// It is a program, not a part of one: it takes over the signals of the process, bounds its memory, and may end it.
#[must_use]
pub fn run_program(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    interrupt::survive_size_limits();
    let code = match Cli::try_parse_from(&arguments) {
        // It is told before anything is asked for.
        _ if asks_for_internals(&arguments) => {
            print(&help_of_internals(&arguments));
            0
        }
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
            2
        }
        None => code,
    }
}

/// Whether `--help-search` is among the arguments.
fn asks_for_internals(arguments: &[OsString]) -> bool {
    arguments.iter().skip(1).take_while(|argument| *argument != "--").any(|argument| argument == "--help-search")
}

/// The options that change how a search works, of the command that is named.
fn help_of_internals(arguments: &[OsString]) -> String {
    let mut all = Cli::command();
    all.build();
    let mut names = arguments.iter().skip(1);
    let named = names.find_map(|name| all.find_subcommand(name).cloned());
    let command = named.unwrap_or(all).mut_args(|argument| {
        let is_internal = argument.get_help_heading() == Some(INTERNALS);
        argument.hide(!is_internal)
    });
    format!("{}\n", command.disable_help_subcommand(true).render_help())
}

fn run(mut cli: Cli) -> u8 {
    if let Some(level) = cli.simd {
        cli.command.force(level);
    }
    let limit = cli.memory_limit.unwrap_or_else(MemoryLimit::of_machine);
    cli.command.bound(limit);
    watchdog::start(limit);
    let mesh_cache = if cli.no_mesh_cache { None } else { MeshCache::of_user() };
    let xacro = match cli.xacro.as_str() {
        "always" => XacroUse::Always,
        "never" => XacroUse::Never,
        _ => XacroUse::Models,
    };
    let packages = PackagePath::from_environment(&cli.package_path).with_mesh_cache(mesh_cache).with_xacro(xacro);
    let ending = match &cli.command {
        Command::Demo(arguments) => demo::run(arguments, &packages),
        Command::Solve(arguments) => run::run(arguments, &packages),
        Command::Certify(arguments) => crate::cli::commands::certify::run::run(arguments, &packages),
        Command::Check(arguments) => check::run(arguments, &packages),
        Command::Export(arguments) => export::run(arguments, &packages),
        Command::Bench(arguments) => bench::run::run(arguments, &packages),
        Command::Graph(arguments) => graph::run(arguments, &packages),
        Command::Inspect(arguments) => crate::cli::commands::inspect::run::run(arguments, &packages),
        Command::Models(arguments) => install::run(arguments, &packages),
        Command::New(arguments) => new::run(arguments, &packages),
        Command::Scenes(arguments) => scenes::run(arguments),
        Command::View(arguments) => crate::cli::commands::view::run::run(arguments, &packages),
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
