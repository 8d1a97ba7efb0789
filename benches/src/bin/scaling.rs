//! What does a candidate cost with a thousand, ten thousand and a hundred thousand nodes in the roadmap?
//!
//! `cargo run --profile dist -p foliate_benches --bin scaling [-- SCENE… --nodes N --seed S --selection RULE]`. Whole steps of `mrrt`
//! with settings that are otherwise the default, on one thread, but connections are proved and then forgotten, so that the trees stay apart and a search never
//! ends: what it does at any size is what an unsolved one does. Processor time, since the machine may be busy; below each line
//! the shares of the sets of a step.
#![forbid(unsafe_code)]

use bevy_ecs::prelude::{IntoScheduleConfigs, ResMut, Resource, Schedule, World};
use foliate_benches::{long_model, mrrt_without_connections, one_thread, processor_time, scene_model};
use foliate_components::graph::leaf::LeafIndex;
use foliate_schedulers::Scheduler;
use foliate_systems::events::{EventSink, StopSignal};
use foliate_systems::exploration::edges::Connections;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::schedule::SearchSet;
use foliate_systems::search::Search;
use foliate_systems::settings::{SearchSettings, Selection};
use foliate_systems::step::commit;
use foliate_systems::step::connection::connect::{certify_connections, propose_connections};
use std::error::Error;
use std::time::Duration;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Candidates over which a cost is taken; enough for all kinds of transitions to be among them.
const WINDOW: u64 = 4096;

fn main() -> Result<()> {
    one_thread();
    let mut arguments = std::env::args().skip(1);
    let (mut scenes, mut most, mut settings) = (Vec::new(), 100_000, SearchSettings::default());
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--nodes" => most = arguments.next().ok_or("--nodes N")?.parse()?,
            "--seed" => settings.seed = arguments.next().ok_or("--seed S")?.parse()?,
            "--selection" => settings.selection = selection(&arguments.next().ok_or("--selection RULE")?)?,
            scene => scenes.push(scene.to_owned()),
        }
    }
    if scenes.is_empty() {
        scenes = vec!["four boxes".to_owned(), "demo".to_owned(), "baxter-case2".to_owned()];
    }
    println!(
        "{:<24} {:>7} {:>7} {:>6} {:>9} {:>12} {:>14}",
        "scene", "nodes", "leaves", "trees", "µs each", "× first", "fingerprint"
    );
    for scene in &scenes {
        let model = if scene == "four boxes" { Some(long_model()) } else { scene_model(scene) };
        if let Some(model) = model {
            measure(scene, &model, most, &settings);
        }
    }
    Ok(())
}

fn selection(name: &str) -> Result<Selection> {
    match name {
        "guided" => Ok(Selection::Guided),
        "leaf-first" => Ok(Selection::LeafFirst),
        "state-first" => Ok(Selection::StateFirst),
        "nearest" => Ok(Selection::Nearest),
        _ => Err(format!("no selection `{name}`").into()),
    }
}

/// Grows one roadmap and says what candidates cost on the way.
fn measure(scene: &str, model: &PlanningModel, most: usize, settings: &SearchSettings) {
    let mut search = Search::new(model, &Apart, settings.clone(), StopSignal::default(), EventSink::default());
    let mut first = None;
    let mut size = 1000;
    while size <= most {
        while search.roadmap().nodes().len() < size {
            if let Some(outcome) = search.step() {
                println!("{scene}: {} at {} nodes", outcome.name(), search.roadmap().nodes().len());
                return;
            }
        }
        let leaves = search.world().resource::<LeafIndex>().leaves().len();
        let (nodes, trees) = (search.roadmap().nodes().len(), search.roadmap().tree_count());
        search.world_mut().resource_mut::<Laps>().spent = [Duration::ZERO; SETS.len()];
        let (before, started) = (search.counter().candidates, processor_time());
        while search.counter().candidates < before + WINDOW && search.step().is_none() {}
        let each = (processor_time() - started).as_secs_f64() * 1e6 / (search.counter().candidates - before) as f64;
        let times = each / *first.get_or_insert(each);
        let print = search.roadmap().fingerprint();
        println!("{scene:<24} {nodes:>7} {leaves:>7} {trees:>6} {each:>9.1} {times:>12.2} {print:016x}");
        println!("{}", search.world().resource::<Laps>().shares());
        size *= 10;
    }
}

const SETS: [SearchSet; 9] = [
    SearchSet::Sample,
    SearchSet::Select,
    SearchSet::Rendezvous,
    SearchSet::Project,
    SearchSet::Steer,
    SearchSet::Validate,
    SearchSet::Commit,
    SearchSet::Connect,
    SearchSet::Conclude,
];

/// Processor time per set.
#[derive(Default, Resource)]
struct Laps {
    last: Duration,
    spent: [Duration; SETS.len()],
}

impl Laps {
    fn shares(&self) -> String {
        let all: Duration = self.spent.iter().sum();
        let share = |time: &Duration| 100.0 * time.as_secs_f64() / all.as_secs_f64();
        let shares: Vec<_> = SETS.iter().zip(&self.spent).map(|(s, t)| format!("{s:?} {:.1} %", share(t))).collect();
        format!("    {}", shares.join(", "))
    }
}

/// The papers' algorithm, but for trees that never meet.
struct Apart;

impl Scheduler for Apart {
    fn name(&self) -> &'static str {
        "apart"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = mrrt_without_connections(world);
        let connect = (propose_connections, certify_connections, forget, commit::commit_connections);
        schedule.add_systems(connect.chain().in_set(SearchSet::Connect));
        world.init_resource::<Laps>();
        schedule.add_systems((|mut laps: ResMut<'_, Laps>| laps.last = processor_time()).before(SETS[0]));
        for (index, set) in SETS.into_iter().enumerate() {
            let lap = move |mut laps: ResMut<'_, Laps>| {
                let now = processor_time();
                let last = std::mem::replace(&mut laps.last, now);
                laps.spent[index] += now.saturating_sub(last);
            };
            match SETS.get(index + 1) {
                Some(&next) => schedule.add_systems(lap.after(set).before(next)),
                None => schedule.add_systems(lap.after(set)),
            };
        }
        schedule
    }
}

fn forget(mut connections: ResMut<'_, Connections>) {
    connections.0.iter_mut().for_each(|connection| connection.verdict = None);
}
