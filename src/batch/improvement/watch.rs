//! Keeps the paths of an improvement at its checkpoints, and looks at them once it has ended.

use crate::batch::improvement::checkpoint::Checkpoint;
use crate::batch::improvement::numbers::{AnswerNumbers, ImprovementNumbers};
use crate::planner::answer::Solution;
use crate::planner::refinement::{BetterPath, ImprovementReport, KeptPath};
use crate::planner::solving::Planner;
use foliate_components::path::{ManipulationPath, events};
use foliate_systems::planning_model::PlanningModel;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Sees the paths of one solve. What it does while the improvement goes on takes microseconds.
#[derive(Debug)]
pub(crate) struct Watch {
    checkpoints: Vec<Duration>,
    seen: Mutex<Seen>,
}

#[derive(Debug, Default)]
struct Seen {
    first: Option<(PlanningModel, ManipulationPath)>,
    /// The best so far; `None` as long as that is the first.
    best: Option<Arc<KeptPath>>,
    /// The best at each checkpoint that has passed.
    passed: Vec<Option<Arc<KeptPath>>>,
}

/// What there is to say of a path.
#[derive(Clone, Copy, Debug)]
struct Measured {
    duration: Option<f64>,
    grasp_changes: usize,
    length: f64,
}

impl Watch {
    pub(crate) fn new(checkpoints: &[Duration]) -> Arc<Self> {
        Arc::new(Self { checkpoints: checkpoints.to_vec(), seen: Mutex::default() })
    }

    /// A planner that shows its paths.
    pub(crate) fn on(self: &Arc<Self>, planner: Planner) -> Planner {
        let (first, better) = (Arc::clone(self), Arc::clone(self));
        planner
            .on_first_path(move |model, path| first.seen().first = Some((model.clone(), path.clone())))
            .on_better_path(move |path| better.see(path))
    }

    fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn see(&self, path: &BetterPath<'_>) {
        let mut seen = self.seen();
        // The path before this one is that of every checkpoint in between.
        self.pass(&mut seen, |checkpoint| checkpoint < path.elapsed());
        seen.best = Some(Arc::new(path.keep()));
    }

    fn pass(&self, seen: &mut Seen, has_passed: impl Fn(Duration) -> bool) {
        while self.checkpoints.get(seen.passed.len()).is_some_and(|&checkpoint| has_passed(checkpoint)) {
            let best = seen.best.clone();
            seen.passed.push(best);
        }
    }

    /// What has become of the first path of a solve that has ended. Times the paths of all checkpoints, as the planner times answers.
    pub(crate) fn numbers(&self, planner: &Planner, solution: &Solution) -> AnswerNumbers {
        let report = &solution.report;
        AnswerNumbers {
            grasp_changes: events(&solution.path).len(),
            duration: solution.path.duration(),
            timing_time: report.timing_time,
            untimed: report.untimed.as_ref().map(ToString::to_string),
            improvement: report.improvement.as_ref().map(|improvement| ImprovementNumbers {
                first_cost: improvement.first_cost,
                final_cost: improvement.final_cost,
                work: improvement.work,
                time: improvement.time,
                checkpoints: self.checkpoints(planner, solution, improvement),
                history: improvement.history.clone(),
            }),
        }
    }

    fn checkpoints(&self, planner: &Planner, solution: &Solution, improvement: &ImprovementReport) -> Vec<Checkpoint> {
        let mut seen = self.seen();
        let Some((model, first)) = seen.first.clone() else { return Vec::new() };
        self.pass(&mut seen, |checkpoint| checkpoint <= improvement.time);
        let mut measured = Measured::of(planner, &model, &first);
        let row = |at, (work, cost), measured: Measured| Checkpoint {
            at: Some(at),
            time: at,
            work,
            cost,
            duration: measured.duration,
            grasp_changes: measured.grasp_changes,
            length: measured.length,
        };
        let mut rows = vec![row(Duration::ZERO, (0, improvement.first_cost), measured)];
        let mut last: Option<&Arc<KeptPath>> = None;
        for (&at, path) in self.checkpoints.iter().zip(&seen.passed) {
            if let Some(path) = path.as_ref().filter(|path| last.is_none_or(|last| !Arc::ptr_eq(last, path))) {
                measured = Measured::of(planner, path.model(), &path.path());
                last = Some(path);
            }
            let state = path.as_ref().map_or((0, improvement.first_cost), |path| (path.work(), path.cost()));
            rows.push(row(at, state, measured));
        }
        let length = match &seen.best {
            Some(best) => length(best.model(), &best.path()),
            None => length(&model, &first),
        };
        rows.push(Checkpoint {
            at: None,
            time: improvement.time,
            work: improvement.work,
            cost: improvement.final_cost,
            duration: solution.path.duration(),
            grasp_changes: events(&solution.path).len(),
            length,
        });
        rows
    }
}

impl Measured {
    fn of(planner: &Planner, model: &PlanningModel, path: &ManipulationPath) -> Self {
        let timed = planner.timed_path(model, path).ok();
        Self {
            duration: timed.and_then(|path| path.duration()),
            grasp_changes: events(path).len(),
            length: length(model, path),
        }
    }
}

/// Weighted length, metres.
fn length(model: &PlanningModel, path: &ManipulationPath) -> f64 {
    path.segments.iter().map(|segment| model.length(&segment.knots.concat())).sum()
}
