//! What the benches share: problems, random configurations, one thread.
#![forbid(unsafe_code)]
#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a bench that cannot be set up has nothing to measure")]

pub mod feasibility;
pub mod humanoid;
pub mod motionbenchmaker;

use bevy_ecs::prelude::{Schedule, World};
use bevy_ecs::schedule::ScheduleCleanupPolicy;
use criterion::Criterion;
use foliate::batch::Entry;
use foliate::scene::PackagePath;
use foliate_components::robot::Robot;
use foliate_components::samples::{boxes_on_a_table, swap_two_boxes};
use foliate_schedulers::{Scheduler, mrrt::Mrrt};
use foliate_systems::events::{EventSink, StopSignal};
use foliate_systems::planning_model::{Model, PlanningModel};
use foliate_systems::schedule::SearchSet;
use foliate_systems::search::Search;
use foliate_systems::settings::SearchSettings;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Processor time of this thread, since the machine may be busy; wall time since the first call where the system does not tell.
#[must_use]
pub fn processor_time() -> Duration {
    thread_local! {
        static START: Instant = Instant::now();
    }
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next().and_then(|n| n.parse().ok()));
    nanoseconds.map_or_else(|| START.with(Instant::elapsed), Duration::from_nanos)
}

/// The systems of `mrrt` without those that join trees: a search that never ends.
///
/// # Panics
/// Never: nothing of that schedule depends on these systems.
pub fn mrrt_without_connections(world: &mut World) -> Schedule {
    let mut schedule = Mrrt.schedule(world);
    let cleanup = ScheduleCleanupPolicy::RemoveSystemsOnly;
    schedule.remove_systems_in_set(SearchSet::Connect, world, cleanup).expect("mrrt has systems in set Connect");
    schedule
}

/// Short enough to run all of them over a cup of coffee.
#[must_use]
pub fn criterion() -> Criterion {
    Criterion::default()
        .measurement_time(Duration::from_secs(2))
        .warm_up_time(Duration::from_millis(500))
        .configure_from_args()
}

/// Makes this thread the only one of rayon's pool, so that what is measured is one core's work and nothing is handed over.
pub fn one_thread() {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().expect("the first pool");
}

/// Two boxes that change places under one seven-axis arm; shapes are primitives.
#[must_use]
pub fn sample_model() -> PlanningModel {
    PlanningModel(Arc::new(Model::new(swap_two_boxes().expect("fixed models")).expect("a sound problem")))
}

/// Four boxes that change places in a circle under one seven-axis arm: not solved within the steps that a bench takes.
#[must_use]
pub fn long_model() -> PlanningModel {
    let places = [(0.5, 0.2), (0.75, 0.2), (0.75, -0.2), (0.5, -0.2)];
    let mut goals = places;
    goals.rotate_left(1);
    let problem = boxes_on_a_table(&places, &goals).expect("fixed models");
    PlanningModel(Arc::new(Model::new(problem).expect("a sound problem")))
}

/// A search that has tried `warm_up` candidates, so many a step: that of the next seed which is not solved by then; none where all
/// up to `seeds` are.
#[must_use]
pub fn under_way(
    model: &PlanningModel,
    candidates: usize,
    warm_up: usize,
    seeds: u64,
    seed: &mut u64,
) -> Option<Search> {
    while *seed < seeds {
        *seed += 1;
        let settings = SearchSettings::default().with(|s| (s.seed, s.candidates) = (*seed, candidates));
        let mut search = Search::new(model, &Mrrt, settings, StopSignal::default(), EventSink::default());
        if (0..warm_up / candidates).all(|_| search.step().is_none()) {
            return Some(search);
        }
    }
    None
}

/// The model of a shipped scene; `None`, and said so, where its published robots are not at hand.
#[must_use]
pub fn scene_model(name: &str) -> Option<PlanningModel> {
    match Entry::load(name, &PackagePath::from_environment(&[])) {
        Ok(entry) => Some(entry.model().clone()),
        Err(error) => {
            skipped(name, &error.to_string());
            None
        }
    }
}

/// Says that a scene is left out, and why.
pub fn skipped(name: &str, why: &str) {
    eprintln!("SKIPPED {name}: {why}\n(`foliate models --install` or FOLIATE_PACKAGE_PATH=DIR brings the models)");
}

/// Configurations, uniform within bounds, the same in every run.
#[must_use]
pub fn random_configurations(robot: &Robot, count: usize) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut q = robot.space.neutral();
    let mut one = || {
        robot.space.random(&mut rng, &mut q);
        q.clone()
    };
    (0..count).map(|_| one()).collect()
}
