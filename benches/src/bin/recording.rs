//! What does it cost to record a search?
//!
//! `cargo run --release -p foliate_benches --bin recording [-- SCENE… --seeds N --steps N]`. First paths on one thread, with a recording and without
//! it in turn, for each seed; the last line of a scene is of a search that never ends: trees of `mrrt` that are not joined, for `--steps` steps.
//! Processor time, since the machine may be busy. What the search takes more, and apart from it what it takes to make the recording of its
//! answer and the bytes of the file.
#![forbid(unsafe_code)]

use bevy_ecs::prelude::{Schedule, World};
use bevy_ecs::schedule::ScheduleCleanupPolicy;
use foliate::batch::Entry;
use foliate::path_file::{PathContext, save};
use foliate::recording::Recording;
use foliate::scene::PackagePath;
use foliate::{NoSolution, Planner, Report, Solution};
use foliate_benches::{one_thread, processor_time};
use foliate_schedulers::{Scheduler, mrrt::Mrrt, sequence::Sequence};
use foliate_systems::schedule::SearchSet;
use foliate_systems::settings::SearchSettings;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// `mrrt` whose trees are never joined.
struct Apart;

impl Scheduler for Apart {
    fn name(&self) -> &'static str {
        "apart"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = Mrrt.schedule(world);
        let cleanup = ScheduleCleanupPolicy::RemoveSystemsOnly;
        let removed = schedule.remove_systems_in_set(SearchSet::Connect, world, cleanup);
        assert!(removed.is_ok(), "mrrt has systems in set Connect");
        schedule
    }
}

fn main() -> Result<()> {
    one_thread();
    let mut arguments = std::env::args().skip(1);
    let (mut scenes, mut seeds, mut steps) = (Vec::new(), 10, 400);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--seeds" => seeds = arguments.next().ok_or("--seeds N")?.parse()?,
            "--steps" => steps = arguments.next().ok_or("--steps N")?.parse()?,
            scene => scenes.push(scene.to_owned()),
        }
    }
    if scenes.is_empty() {
        scenes = ["demo", "baxter-case4", "pr2-manipulation-kitchen"].map(str::to_owned).to_vec();
    }
    println!(
        "{:<34} {:>9} {:>9} {:>26} {:>8} {:>9} {:>8} {:>8}",
        "search", "off ms", "on ms", "more % (quartiles)", "nodes", "make ms", "bytes", "pairs"
    );
    for scene in &scenes {
        match Entry::load(scene, &PackagePath::from_environment(&[])) {
            Err(error) => println!("{scene}: skipped: {error}"),
            Ok(entry) => {
                measure(scene, &entry, Sequence, seeds, 0);
                measure(&format!("{scene}, apart"), &entry, Apart, (seeds / 3).max(3), steps);
            }
        }
    }
    Ok(())
}

/// Processor time of solves in milliseconds, and the last answer.
fn solve(entry: &Entry, scheduler: &Arc<dyn Scheduler>, seed: u64, steps: u64, is_recorded: bool) -> (f64, Answer) {
    let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (seed, steps));
    let planner = Planner::from_model(entry.model().clone()).settings(settings).first_path();
    let planner = planner.scheduler(Arc::clone(scheduler));
    let planner = if is_recorded { planner.record() } else { planner };
    let began = processor_time();
    let answer = planner.solve();
    ((processor_time() - began).as_secs_f64() * 1e3, answer)
}

type Answer = std::result::Result<Solution, NoSolution>;

fn measure(name: &str, entry: &Entry, scheduler: impl Scheduler + 'static, seeds: u64, steps: u64) {
    let scheduler: Arc<dyn Scheduler> = Arc::new(scheduler);
    let _warm = solve(entry, &scheduler, 1, steps, true);
    let (mut off, mut on, mut more, mut made) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut nodes, mut bytes, mut pairs) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 1..=seeds {
        // In turn, and every other seed the other way round; the least of three of each, since others use the machine.
        let mut least = [f64::INFINITY; 2];
        let mut recorded = None;
        for round in 0..6 {
            let is_recorded = (seed + round) % 2 == 0;
            let (time, answer) = solve(entry, &scheduler, seed, steps, is_recorded);
            least[usize::from(is_recorded)] = least[usize::from(is_recorded)].min(time);
            if is_recorded {
                recorded = Some(answer);
            }
        }
        let [without, with] = least;
        off.push(without);
        on.push(with);
        more.push(100.0 * (with / without - 1.0));
        let Some(answer) = recorded else { continue };
        nodes.push(Report::of(&answer).nodes as f64);
        let began = processor_time();
        let recording = recording(entry, &answer);
        let length = recording.to_bytes().map_or(0, |bytes| bytes.len());
        made.push((processor_time() - began).as_secs_f64() * 1e3);
        bytes.push(length as f64);
        pairs.push(recording.head.collisions as f64);
    }
    let [low, middle, high] = [0.25, 0.5, 0.75].map(|share| quantile(&mut more, share));
    let spread = format!("{middle:+.2} ({low:+.2} .. {high:+.2})");
    let median = |numbers: &mut Vec<f64>| quantile(numbers, 0.5);
    println!(
        "{name:<34} {:>9.2} {:>9.2} {spread:>26} {:>8.0} {:>9.2} {:>8.0} {:>8.0}",
        median(&mut off),
        median(&mut on),
        median(&mut nodes),
        median(&mut made),
        median(&mut bytes),
        median(&mut pairs),
    );
}

fn recording(entry: &Entry, answer: &Answer) -> Recording {
    let graph = match answer {
        Ok(solution) => &solution.model.graph,
        Err(none) => &none.model.graph,
    };
    // Beside a device no models are written.
    let names = entry.scene().and_then(|scene| save::model_names(scene, Path::new("/dev/null")).ok());
    let models = names.unwrap_or_default();
    let problem = &entry.model().problem;
    let context = PathContext { problem, graph, models: &models, seed: 1, scheduler: "measured", simd: "measured" };
    Recording::of(&context, answer)
}

fn quantile(numbers: &mut [f64], share: f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let place = (share * (numbers.len().max(1) - 1) as f64).round() as usize;
    numbers.get(place).copied().unwrap_or(f64::NAN)
}
