//! Searches that the tests share.
#![allow(dead_code, reason = "every test file uses some of it")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

use bevy_ecs::prelude::{Schedule, World};
use bevy_ecs::schedule::ScheduleCleanupPolicy;
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::Problem;
use foliate_schedulers::{Scheduler, mrrt::Mrrt};
use foliate_systems::events::{EventSink, StopSignal};
use foliate_systems::planning_model::{Model, PlanningModel};
use foliate_systems::schedule::SearchSet;
use foliate_systems::search::Search;
use foliate_systems::settings::SearchSettings;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// `mrrt` that never joins two trees, and so never solves anything.
pub struct Unconnected;

impl Scheduler for Unconnected {
    fn name(&self) -> &'static str {
        "unconnected"
    }

    fn schedule(&self, world: &mut World) -> Schedule {
        let mut schedule = Mrrt.schedule(world);
        let cleanup = ScheduleCleanupPolicy::RemoveSystemsOnly;
        schedule.remove_systems_in_set(SearchSet::Connect, world, cleanup).unwrap();
        schedule
    }
}

/// A deadline that no small problem should need.
pub fn stop_within(seconds: u64) -> StopSignal {
    StopSignal { deadline: Some(Instant::now() + Duration::from_secs(seconds)), ..StopSignal::default() }
}

pub fn model(problem: Problem) -> PlanningModel {
    PlanningModel(Arc::new(Model::new(problem).unwrap()))
}

/// Runs a search to its end on `threads` threads.
pub fn search(
    model: &PlanningModel,
    scheduler: &dyn Scheduler,
    settings: SearchSettings,
    threads: usize,
) -> (SearchOutcome, Search) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut search = Search::new(model, scheduler, settings, stop_within(120), EventSink::default());
        (search.run(), search)
    })
}

pub fn seeded(seed: u64) -> SearchSettings {
    SearchSettings::default().with(|s| s.seed = seed)
}
