//! What is asked of a search besides the scene.

use foliate::memory::MemoryLimit;
use foliate::prelude::{CancelToken, Planner};
use foliate::schedulers::{Scheduler, named, shipped};
use foliate::systems::planning_model::PlanningModel;
use foliate::systems::settings::SearchSettings;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Settings of a search, found right.
pub(crate) struct Request {
    seed: u64,
    scheduler: Arc<dyn Scheduler>,
    limit: Duration,
    threads: usize,
    answer: Answer,
    candidates: usize,
    memory: Option<MemoryLimit>,
}

/// What is wanted.
enum Answer {
    First,
    Usual,
    ImprovedByWork(u64),
    ImprovedFor(Duration),
}

impl Request {
    /// Of what Python gives: seed, limit in seconds, threads and scheduler; whether the first path is wanted, or how much it is improved, in work or in
    /// seconds; candidates of a step and the limit of memory.
    pub(crate) fn of(
        (seed, time_limit, threads, scheduler): (u64, f64, u16, &str),
        (first, improve_work, improve_time): (bool, Option<u64>, Option<f64>),
        (candidates, memory_limit): (u16, Option<&str>),
    ) -> PyResult<Self> {
        if threads == 0 || candidates == 0 {
            return Err(PyValueError::new_err("`threads` and `candidates` are at least 1"));
        }
        let Some(scheduler) = named(scheduler) else {
            let known = schedulers().join(", ");
            return Err(PyValueError::new_err(format!("there is no scheduler `{scheduler}`; known: {known}")));
        };
        let answer = match (first, improve_work, improve_time) {
            (_, Some(_), Some(_)) => return Err(PyValueError::new_err("either `improve_work` or `improve_time`")),
            (_, Some(work), None) => Answer::ImprovedByWork(work),
            (_, None, Some(time)) => Answer::ImprovedFor(seconds("improve_time", time)?),
            (true, None, None) => Answer::First,
            (false, None, None) => Answer::Usual,
        };
        let memory = memory_limit
            .map(|text| text.parse().map_err(|why| PyValueError::new_err(format!("memory_limit: {why}"))))
            .transpose()?;
        let limit = seconds("time_limit", time_limit)?;
        let (threads, candidates) = (usize::from(threads), usize::from(candidates));
        Ok(Self { seed, scheduler: scheduler.into(), limit, threads, answer, candidates, memory })
    }

    /// A planner of these settings. What has passed since `begun` is taken from its time.
    pub(crate) fn planner(&self, model: PlanningModel, begun: Instant, token: &CancelToken) -> Planner {
        let settings = SearchSettings::default().with(|s| {
            s.seed = self.seed;
            s.candidates = self.candidates;
        });
        let planner = Planner::from_model(model).settings(settings).cancelled_by(token.clone());
        let planner = planner.time_limit(self.limit.saturating_sub(begun.elapsed()));
        let planner = match self.answer {
            Answer::First => planner.first_path(),
            Answer::Usual => planner,
            Answer::ImprovedByWork(work) => planner.improve_work(work),
            Answer::ImprovedFor(time) => planner.improve_time(time),
        };
        let planner = match self.memory {
            Some(limit) => planner.memory_limit(limit),
            None => planner,
        };
        planner.scheduler(Arc::clone(&self.scheduler))
    }

    /// Threads of the search.
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    /// Seed and scheduler, as path files say them.
    pub(crate) fn label(&self) -> (u64, String) {
        (self.seed, self.scheduler.name().to_owned())
    }
}

/// The schedulers that are shipped.
#[pyfunction]
pub fn schedulers() -> Vec<&'static str> {
    shipped().iter().map(|scheduler| scheduler.name()).collect()
}

fn seconds(what: &str, value: f64) -> PyResult<Duration> {
    Duration::try_from_secs_f64(value)
        .map_err(|_| PyValueError::new_err(format!("{what}: {value} is not a number of seconds")))
}
