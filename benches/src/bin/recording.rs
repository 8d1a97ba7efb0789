//! What does it cost to record a search?
//!
//! `cargo run --profile dist -p foliate_benches --bin recording [-- SCENE… --seeds N --steps N --rounds N]`. First paths on one thread, without a
//! recording and with it in turn; the second line of a scene is of a search that never ends: trees of `mrrt` that are not joined, for
//! `--steps` steps. Of each seed the least time on the clock of so many rounds counts, since others use the machine: what a recording takes more
//! of all seeds together, and the median over seeds with quartiles. The copy that is kept of the roadmap is part of it. Apart from that the time in which
//! the file is made of it, and its bytes.
#![forbid(unsafe_code)]

use bevy_ecs::prelude::{Schedule, World};
use foliate::batch::Entry;
use foliate::path_file::{PathContext, save};
use foliate::recording::Recording;
use foliate::scene::PackagePath;
use foliate::{NoSolution, Planner, Report, Solution};
use foliate_benches::{mrrt_without_connections, one_thread};
use foliate_schedulers::{Scheduler, sequence::Sequence};
use foliate_systems::settings::SearchSettings;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// `mrrt` whose trees are never joined.
struct Apart;

impl Scheduler for Apart {
    fn name(&self) -> &'static str {
        "apart"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        mrrt_without_connections(world)
    }
}

fn main() -> Result<()> {
    one_thread();
    let mut arguments = std::env::args().skip(1);
    let (mut scenes, mut seeds, mut steps, mut rounds) = (Vec::new(), 10, 400, 30);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--seeds" => seeds = arguments.next().ok_or("--seeds N")?.parse()?,
            "--steps" => steps = arguments.next().ok_or("--steps N")?.parse()?,
            "--rounds" => rounds = arguments.next().ok_or("--rounds N")?.parse()?,
            scene => scenes.push(scene.to_owned()),
        }
    }
    if scenes.is_empty() {
        scenes = ["demo", "baxter-case4", "pr2-manipulation-kitchen"].map(str::to_owned).to_vec();
    }
    println!(
        "{:<34} {:>9} {:>9} {:>34} {:>8} {:>9} {:>8} {:>8}",
        "search", "off ms", "on ms", "more %: all, median (quartiles)", "nodes", "make ms", "bytes", "pairs"
    );
    for scene in &scenes {
        match Entry::load(scene, &PackagePath::from_environment(&[])) {
            Err(error) => println!("{scene}: skipped: {error}"),
            Ok(entry) => {
                let entry = &entry;
                measure(scene, &Searched { entry, scheduler: Arc::new(Sequence), seeds, steps: 0 }, rounds);
                let apart = Searched { entry, scheduler: Arc::new(Apart), seeds: seeds.div_ceil(5), steps };
                measure(&format!("{scene}, apart"), &apart, rounds.div_ceil(3));
            }
        }
    }
    Ok(())
}

type Answer = std::result::Result<Solution, NoSolution>;

/// What is searched, and how.
struct Searched<'a> {
    entry: &'a Entry,
    scheduler: Arc<dyn Scheduler>,
    seeds: u64,
    steps: u64,
}

impl Searched<'_> {
    fn solve(&self, seed: u64, is_recorded: bool) -> Answer {
        let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (seed, self.steps));
        let planner = Planner::from_model(self.entry.model().clone()).settings(settings).first_path();
        let planner = planner.scheduler(Arc::clone(&self.scheduler));
        let planner = if is_recorded { planner.record() } else { planner };
        planner.solve()
    }

    /// Time on the clock of a solve, milliseconds.
    fn time(&self, seed: u64, is_recorded: bool) -> f64 {
        let began = Instant::now();
        let answer = self.solve(seed, is_recorded);
        let taken = began.elapsed().as_secs_f64() * 1e3;
        drop(answer);
        taken
    }

    /// The least times of solves without and with a recording, in turn and every other round the other way round.
    fn least(&self, seed: u64, rounds: u64) -> [f64; 2] {
        let mut least = [f64::INFINITY; 2];
        for round in 0..rounds {
            for turn in 0..2 {
                let is_recorded = (round + turn) % 2 == 1;
                let at = usize::from(is_recorded);
                least[at] = least[at].min(self.time(seed, is_recorded));
            }
        }
        least
    }
}

fn measure(name: &str, searched: &Searched<'_>, rounds: u64) {
    // The first solves compile what all share.
    (1..=searched.seeds).for_each(|seed| drop(searched.solve(seed, true)));
    let (mut off, mut on, mut more) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 1..=searched.seeds {
        let [without, with] = searched.least(seed, rounds);
        off.push(without);
        on.push(with);
        more.push(100.0 * (with / without - 1.0));
    }
    let all = 100.0 * (on.iter().sum::<f64>() / off.iter().sum::<f64>() - 1.0);
    let (mut nodes, mut made, mut bytes, mut pairs) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for seed in 1..=searched.seeds {
        let answer = searched.solve(seed, true);
        nodes.push(Report::of(&answer).nodes as f64);
        let began = Instant::now();
        let recording = recording(searched.entry, &answer);
        bytes.push(recording.to_bytes().map_or(0, |bytes| bytes.len()) as f64);
        made.push(began.elapsed().as_secs_f64() * 1e3);
        pairs.push(recording.head.collisions as f64);
    }
    let [low, middle, high] = [0.25, 0.5, 0.75].map(|share| quantile(&mut more, share));
    let spread = format!("{all:+.2}, {middle:+.2} ({low:+.2} .. {high:+.2})");
    let median = |numbers: &mut Vec<f64>| quantile(numbers, 0.5);
    println!(
        "{name:<34} {:>9.2} {:>9.2} {spread:>34} {:>8.0} {:>9.2} {:>8.0} {:>8.0}",
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
