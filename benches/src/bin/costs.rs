//! What Foliate costs besides time per problem: dependencies, build time, memory, start-up, and what steps of a search ask
//! of the allocator.
//!
//! `cargo run --profile dist -p foliate_benches --bin costs [-- --build] [--bin PATH]`. With `--build` the kernel crate is built
//! afresh into a folder of its own, which takes minutes. The program to run is `foliate` beside this one, or `--bin`.
#![forbid(unsafe_code)]

use allocation_counter::measure;
use foliate::batch::{Machine, today};
use foliate_benches::{long_model, one_thread, scene_model, under_way};
use foliate_components::roadmap::RoadmapStore;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::Search;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Between two readings of the peak memory of a program.
const POLL: Duration = Duration::from_millis(2);

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given = arguments.iter().position(|a| a == "--bin").and_then(|i| arguments.get(i + 1));
    let program = given.map_or_else(beside, |path| Ok(PathBuf::from(path)))?;
    println!("{}; {}; foliate {}", Machine::here(), today(), env!("CARGO_PKG_VERSION"));
    println!("crates under foliate_kernels: {}", crates("foliate_kernels", &[])?);
    println!("crates under foliate without the command line: {}", crates("foliate", &["--no-default-features"])?);
    println!("crates under foliate: {}", crates("foliate", &[])?);
    println!("start-up (`foliate scenes`, median of 50): {:.2} ms", start_up(&program)? * 1e3);
    println!("size of the program: {:.1} MB", std::fs::metadata(&program)?.len() as f64 / 1e6);
    println!(
        "memory of a roadmap node beside its configuration, of an edge beside its motions: {} and {} bytes",
        RoadmapStore::NODE_BYTES,
        RoadmapStore::EDGE_BYTES
    );
    for scene in ["baxter-case1", "baxter-case4"] {
        match peak_memory(&program, &["solve", scene, "--json", "--time-limit", "300"])? {
            (_, 2) => println!("SKIPPED peak memory of {scene}: its models are not installed"),
            (peak, code) => println!("peak memory of `foliate solve {scene}` (exit code {code}): {peak:.0} MB"),
        }
    }
    println!("what steps ask of the allocator, after {WARM_UP} candidates and over as many more:");
    one_thread();
    steps("four boxes", &long_model());
    for scene in ["panda-cage", "baxter-case4"] {
        if let Some(model) = scene_model(scene) {
            steps(scene, &model);
        }
    }
    if arguments.iter().any(|a| a == "--build") {
        build_time()?;
    }
    Ok(())
}

/// `foliate` in this program's folder.
fn beside() -> Result<PathBuf> {
    let program = std::env::current_exe()?.with_file_name("foliate");
    if program.exists() { Ok(program) } else { Err("build the program first: cargo build --release".into()) }
}

/// How many crates one depends on, in normal and build edges, itself not counted.
fn crates(package: &str, more: &[&str]) -> Result<usize> {
    let tree = Command::new("cargo")
        .args(["tree", "--package", package, "--edges", "normal,build", "--prefix", "none", "--format", "{p}"])
        .args(more)
        .output()?;
    if !tree.status.success() {
        return Err(String::from_utf8_lossy(&tree.stderr).into());
    }
    let text = String::from_utf8(tree.stdout)?;
    let mut lines: Vec<&str> = text.lines().map(|line| line.trim_end_matches(" (*)")).collect();
    lines.sort_unstable();
    lines.dedup();
    Ok(lines.len().saturating_sub(1))
}

/// Seconds, from start to end, of a command that does nearly nothing.
fn start_up(program: &Path) -> Result<f64> {
    let mut times = Vec::new();
    for _ in 0..50 {
        let started = Instant::now();
        Command::new(program).arg("scenes").stdout(Stdio::null()).status()?;
        times.push(started.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}

/// Peak memory of a program in megabytes (`VmHWM`, read until it ends), and its exit code.
fn peak_memory(program: &Path, arguments: &[&str]) -> Result<(f64, i32)> {
    let mut child = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0.0_f64;
    loop {
        if let Some(now) = std::fs::read_to_string(&status).ok().and_then(|text| high_water_mark(&text)) {
            peak = peak.max(now);
        }
        if let Some(ended) = child.try_wait()? {
            return Ok((peak, ended.code().unwrap_or(-1)));
        }
        std::thread::sleep(POLL);
    }
}

fn high_water_mark(status: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().trim_end_matches(" kB").trim().parse().ok()?;
    Some(kibibytes * 1024.0 / 1e6)
}

/// Candidates before steps are measured, and while they are.
const WARM_UP: usize = 256;

/// Seeds that are tried for a search which lasts long enough.
const SEEDS: u64 = 100;

/// Says how often a candidate asks for memory, how much it gets, and how much of that stays for each new node (with the
/// motion to it): of whole steps with default settings. The counter counts this thread alone, which is all there is.
fn steps(name: &str, model: &PlanningModel) {
    let mut seed = 0;
    while let Some(mut search) = under_way(model, 16, WARM_UP, SEEDS, &mut seed) {
        let before = (search.counter().candidates, search.roadmap().nodes().len());
        let asked = measure(|| go_on(&mut search));
        let candidates = search.counter().candidates - before.0;
        let nodes = search.roadmap().nodes().len() - before.1;
        if candidates < WARM_UP as u64 || nodes == 0 {
            continue;
        }
        let per_candidate = |n: u64| n as f64 / candidates as f64;
        let own = size_of::<f64>() * model.problem.robot.space.size();
        println!(
            "  {name}: {:.1} allocations and {:.0} bytes a candidate; {:.0} bytes kept a node, beyond its configuration of {own}",
            per_candidate(asked.count_total),
            per_candidate(asked.bytes_total),
            asked.bytes_current as f64 / nodes as f64 - own as f64,
        );
        return;
    }
    println!("  {name}: SKIPPED, every search ends too soon");
}

/// As many candidates as before, or to the end of the search.
fn go_on(search: &mut Search) {
    let last = search.counter().candidates + WARM_UP as u64;
    while search.counter().candidates < last && search.step().is_none() {}
}

/// Builds the kernel crate alone: first with all that it stands on, then itself.
fn build_time() -> Result<()> {
    let folder = std::env::temp_dir().join(format!("foliate-costs-{}", std::process::id()));
    let cargo = |arguments: &[&str]| -> Result<f64> {
        let started = Instant::now();
        let done = Command::new("cargo")
            .args(arguments)
            .args(["--release", "--quiet", "--package", "foliate_kernels", "--target-dir"])
            .arg(&folder)
            .status()?;
        if done.success() { Ok(started.elapsed().as_secs_f64()) } else { Err("cargo failed".into()) }
    };
    println!("clean build of foliate_kernels and all under it: {:.1} s", cargo(&["build"])?);
    cargo(&["clean"])?;
    println!("build of foliate_kernels itself: {:.1} s", cargo(&["build"])?);
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}
