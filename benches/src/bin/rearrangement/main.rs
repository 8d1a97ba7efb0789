//! Does the search scale with the number of objects?
//!
//! `cargo run --profile dist -p foliate_benches --bin rearrangement [-- --boxes 5,10 --arms 1,2 --kinds monotone,cyclic,dense --seeds N
//! --time-limit SECONDS --out FOLDER]`. Boxes on a table are moved to given places by `sequence` with default settings, on one thread,
//! each solve in a process of its own, so that its peak memory is known. Times are processor time and count the model's tables. The seed is that of the instance and of the search.
#![forbid(unsafe_code)]

mod instance;
mod plot;

use crate::instance::{Instance, Kind};
use foliate_benches::processor_time;
use foliate_components::graph::ConstraintKind;
use foliate_components::outcome::SearchOutcome;
use foliate_components::path::{ManipulationPath, Segment};
use foliate_schedulers::sequence::Sequence;
use foliate_systems::events::{EventSink, StopSignal};
use foliate_systems::planning_model::{Model, PlanningModel};
use foliate_systems::search::Search;
use foliate_systems::settings::SearchSettings;
use serde_json::{Value, json};
use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// What is asked for.
struct Options {
    boxes: Vec<usize>,
    arms: Vec<usize>,
    kinds: Vec<Kind>,
    seeds: u64,
    time_limit: f64,
    out: Option<PathBuf>,
}

/// A row of the table: solves of one kind and size.
pub struct Row {
    pub(crate) kind: Kind,
    pub(crate) arms: usize,
    pub(crate) boxes: usize,
    solves: Vec<Value>,
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some(("solve", rest)) = arguments.split_first().map(|(first, rest)| (first.as_str(), rest)) {
        return solve(rest);
    }
    let options = Options::read(arguments.into_iter())?;
    let mut table = String::from(
        "| kind | arms | boxes | solved | median (s) | worst (s) | steps | grasps / fewest | peak memory (MB) |\n\
         | :-- | --: | --: | --: | --: | --: | --: | --: | --: |\n",
    );
    print!("{table}");
    let mut rows = Vec::new();
    for (&kind, &arms) in options.kinds.iter().flat_map(|kind| options.arms.iter().map(move |arms| (kind, arms))) {
        for &boxes in &options.boxes {
            let solves = (1..=options.seeds).map(|seed| measure(&options, (kind, arms, boxes), seed));
            let row = Row { kind, arms, boxes, solves: solves.collect::<Result<_>>()? };
            println!("{}", row.text());
            let _ = writeln!(table, "{}", row.text());
            rows.push(row);
        }
    }
    if let Some(folder) = options.out {
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join("rearrangement.md"), table)?;
        std::fs::write(folder.join("rearrangement.svg"), plot::plot(&rows))?;
        let lines: Vec<_> = rows.iter().flat_map(|row| &row.solves).map(Value::to_string).collect();
        std::fs::write(folder.join("rearrangement.jsonl"), lines.join("\n") + "\n")?;
    }
    Ok(())
}

impl Options {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self> {
        let numbers = |text: &str| text.split(',').map(str::parse).collect::<std::result::Result<Vec<usize>, _>>();
        let mut options = Self {
            boxes: vec![5, 10, 20, 40],
            arms: vec![1, 2],
            kinds: Kind::ALL.to_vec(),
            seeds: 20,
            time_limit: 60.0,
            out: None,
        };
        while let Some(option) = arguments.next() {
            let value = arguments.next().ok_or_else(|| format!("{option} VALUE"))?;
            match option.as_str() {
                "--boxes" => options.boxes = numbers(&value)?,
                "--arms" => options.arms = numbers(&value)?,
                "--kinds" => {
                    let named = |name| Kind::named(name).ok_or_else(|| format!("no kind `{name}`"));
                    options.kinds = value.split(',').map(named).collect::<std::result::Result<_, _>>()?;
                }
                "--seeds" => options.seeds = value.parse()?,
                "--time-limit" => options.time_limit = value.parse()?,
                "--out" => options.out = Some(value.into()),
                _ => return Err(format!("no option `{option}`").into()),
            }
        }
        Ok(options)
    }
}

/// Solves one instance in a process of its own.
fn measure(options: &Options, (kind, arms, boxes): (Kind, usize, usize), seed: u64) -> Result<Value> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["solve", kind.name(), &arms.to_string(), &boxes.to_string(), &seed.to_string()]);
    let output = command.arg(options.time_limit.to_string()).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// The process of one solve: prints what came of it as a line of JSON.
fn solve(arguments: &[String]) -> Result<()> {
    let [kind, arms, boxes, seed, limit] = arguments else { return Err("solve KIND ARMS BOXES SEED SECONDS".into()) };
    let kind = Kind::named(kind).ok_or("no such kind")?;
    let (arms, boxes, seed) = (arms.parse()?, boxes.parse()?, seed.parse()?);
    let instance = Instance::new(kind, arms, boxes, seed);
    let problem = instance.problem()?;
    foliate_benches::one_thread();
    let (started, used) = (Instant::now(), processor_time());
    let limit = Duration::from_secs_f64(limit.parse()?);
    let model = PlanningModel(Arc::new(Model::new(problem)?));
    let settings = SearchSettings::default().with(|s| s.seed = seed);
    let mut search = Search::new(&model, &Sequence, settings, StopSignal::default(), EventSink::default());
    let built = processor_time() - used;
    let mut outcome = search.ending().cloned();
    while outcome.is_none() && processor_time() - used < limit {
        outcome = search.step().cloned();
    }
    let path = search.path();
    let spent = processor_time() - used;
    let grasps = path.as_ref().map(|path| grasps(search.model(), path));
    let line = json!({
        "kind": kind.name(), "arms": arms, "boxes": boxes, "seed": seed,
        "outcome": outcome.as_ref().map_or("time limit", SearchOutcome::name),
        "seconds": spent.as_secs_f64(),
        "wall_seconds": started.elapsed().as_secs_f64(),
        "model_seconds": built.as_secs_f64(),
        "steps": search.counter().step,
        "nodes": search.roadmap().nodes().len(),
        "grasps": grasps,
        "fewest": instance.fewest_grasps(),
        "bytes": foliate::memory::peak(),
        "fingerprint": format!("{:016x}", search.roadmap().fingerprint()),
    });
    println!("{line}");
    Ok(())
}

/// How often a gripper takes hold of something along a path.
fn grasps(model: &PlanningModel, path: &ManipulationPath) -> usize {
    let held = |state| {
        let constraints = model.graph.state(state).manifold.iter().copied();
        constraints.filter(|&c| matches!(model.graph.constraint(c).kind, ConstraintKind::Grasp { .. }))
    };
    let taken = |pair: &[Segment]| held(pair[1].state).filter(|c| !held(pair[0].state).any(|h| h == *c)).count();
    path.segments.windows(2).map(taken).sum()
}

impl Row {
    /// The values of a key, of the solves that have an answer, sorted.
    pub fn sorted(&self, key: &str) -> Vec<f64> {
        let mut values: Vec<f64> = self.solved().filter_map(|solve| solve[key].as_f64()).collect();
        values.sort_by(f64::total_cmp);
        values
    }

    fn solved(&self) -> impl Iterator<Item = &Value> {
        self.solves.iter().filter(|solve| solve["outcome"] == SearchOutcome::Solved.name())
    }

    fn text(&self) -> String {
        let median = |values: &[f64]| values.get(values.len() / 2).copied().unwrap_or(f64::NAN);
        let (seconds, steps, bytes) = (self.sorted("seconds"), self.sorted("steps"), self.sorted("bytes"));
        let sum = |key| self.sorted(key).iter().sum::<f64>();
        format!(
            "| {} | {} | {} | {}/{} | {:.3} | {:.3} | {:.0} | {:.2} | {:.0} |",
            self.kind.name(),
            self.arms,
            self.boxes,
            seconds.len(),
            self.solves.len(),
            median(&seconds),
            seconds.last().copied().unwrap_or(f64::NAN),
            median(&steps),
            sum("grasps") / sum("fewest"),
            bytes.last().copied().unwrap_or(f64::NAN) / 1e6,
        )
    }
}
