//! What becomes of the first path: it is improved within a budget of counted work.

use foliate_components::path::ManipulationPath;
use foliate_schedulers::Scheduler;
use foliate_systems::events::StopSignal;
use foliate_systems::improvement::progress::Changes;
use foliate_systems::improvement::proposal::Incumbent;
use foliate_systems::improvement::{Improvement, ImprovementEnding, ImprovementSettings, PathCost, cost};
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::settings::SearchSettings;
use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What a host wants of the first path.
#[derive(Clone, Default)]
pub(crate) struct Refinement {
    /// Whether the first path is the answer.
    pub first: bool,
    /// How much is spent, and on what.
    pub settings: ImprovementSettings,
    /// Wall time after which the improvement ends.
    pub time: Option<Duration>,
    /// What is minimised; the problem's own where there is none.
    pub cost: Option<Arc<dyn PathCost>>,
    /// Called with the first path.
    pub found: Option<FirstPathCallback>,
    /// Called with each better path.
    pub better: Option<BetterPathCallback>,
}

/// A host's function that sees the first path, and the model of its ids.
pub(crate) type FirstPathCallback = Arc<dyn Fn(&PlanningModel, &ManipulationPath) + Send + Sync>;

/// A host's function that sees each better path.
pub(crate) type BetterPathCallback = Arc<dyn Fn(&BetterPath<'_>) + Send + Sync>;

impl fmt::Debug for Refinement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Refinement")
            .field("first", &self.first)
            .field("settings", &self.settings)
            .field("time", &self.time)
            .field("cost", &self.cost)
            .finish_non_exhaustive()
    }
}

/// A path that is better than all before it, while the improvement goes on.
#[derive(Clone, Copy)]
pub struct BetterPath<'a> {
    improvement: &'a Improvement,
    started: Instant,
}

impl BetterPath<'_> {
    /// What the path costs.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.improvement.cost()
    }

    /// Counted work until now.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.improvement.progress().work
    }

    /// Wall time since the improvement began.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }

    /// The path, certified, without times.
    #[must_use]
    pub fn path(&self) -> ManipulationPath {
        self.improvement.path()
    }

    /// The model of the path's ids: where the graph is lazy it has grown with what was planned again.
    #[must_use]
    pub fn model(&self) -> &PlanningModel {
        self.improvement.model()
    }

    /// Takes the path along, to be made after the improvement has ended. It costs less time than [`Self::path`].
    #[must_use]
    pub fn keep(&self) -> KeptPath {
        KeptPath {
            incumbent: self.improvement.incumbent().clone(),
            model: self.improvement.model().clone(),
            settings: self.improvement.search_settings().clone(),
            work: self.work(),
        }
    }
}

/// A better path that outlives its round.
#[derive(Clone, Debug)]
pub struct KeptPath {
    incumbent: Incumbent,
    model: PlanningModel,
    settings: SearchSettings,
    work: u64,
}

impl KeptPath {
    /// What the path costs.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.incumbent.cost
    }

    /// Counted work until it was found. As a budget it gives this path again.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.work
    }

    /// The path, certified, without times. [`Planner::timed_path`](crate::planner::Planner::timed_path) gives it times.
    #[must_use]
    pub fn path(&self) -> ManipulationPath {
        self.incumbent.path(&self.model, &self.settings)
    }

    /// The model of the path's ids.
    #[must_use]
    pub fn model(&self) -> &PlanningModel {
        &self.model
    }
}

impl fmt::Debug for BetterPath<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BetterPath").field("cost", &self.cost()).field("work", &self.work()).finish_non_exhaustive()
    }
}

/// What an improvement has done.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct ImprovementReport {
    /// What the costs are: `duration` (seconds), `length` (metres), or a host's own.
    pub cost: &'static str,
    /// Cost of the first path. That of `duration` is an estimate, without times; [`ManipulationPath::duration`] is exact.
    pub first_cost: f64,
    /// Cost of the path that is answered, likewise.
    pub final_cost: f64,
    /// Counted work. As a budget it gives the same path again.
    pub work: u64,
    /// Wall time.
    pub time: Duration,
    /// Changes that were made.
    pub changes: Changes,
    /// Work, wall time and cost after every round that has made the path better.
    pub history: Vec<CostRow>,
    /// Whether the deadline or the host ended it.
    pub stopped: bool,
}

/// What the path costs from here on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CostRow {
    /// Counted work until then.
    pub work: u64,
    /// Wall time since the improvement began.
    pub time: Duration,
    /// Cost of the path.
    pub cost: f64,
}

impl Refinement {
    /// Improves a path; the model that comes back is that of its ids.
    pub(crate) fn improve(
        &self,
        (model, path): (PlanningModel, ManipulationPath),
        scheduler: &Arc<dyn Scheduler>,
        search: &SearchSettings,
        steps: u64,
        stop: StopSignal,
    ) -> (PlanningModel, ManipulationPath, Option<ImprovementReport>) {
        let started = Instant::now();
        let cost = self.cost.clone().unwrap_or_else(|| cost::shipped(&model.problem).into());
        let settings = self.settings.clone().with(|s| s.first_steps = steps);
        let how = (scheduler.clone(), cost.clone());
        let Some(mut improvement) = Improvement::new(&model, &path, how, (search.clone(), settings), stop) else {
            return (model, path, None);
        };
        let first_cost = improvement.cost();
        let mut history = vec![CostRow { work: 0, time: Duration::ZERO, cost: first_cost }];
        let ending = improvement.run(|improvement| {
            let better = BetterPath { improvement, started };
            history.push(CostRow { work: better.work(), time: better.elapsed(), cost: better.cost() });
            if let Some(callback) = &self.better {
                callback(&better);
            }
        });
        let progress = improvement.progress();
        let report = ImprovementReport {
            cost: cost.name(),
            first_cost,
            final_cost: improvement.cost(),
            work: progress.work,
            time: started.elapsed(),
            changes: progress.changes,
            history,
            stopped: ending == ImprovementEnding::Stopped,
        };
        let path = if report.changes == Changes::default() { path } else { improvement.path() };
        (improvement.model().clone(), path, Some(report))
    }
}
