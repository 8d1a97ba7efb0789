//! One solve of a batch, as a row of `results.csv`.

use crate::batch::improvement::numbers::AnswerNumbers;
use crate::batch::results::csv::csv_line;
use crate::batch::vary::rejections::Rejections;
use crate::planner::answer::NoSolutionReason;
use serde_json::{Value, json};
use std::time::Duration;

/// The columns of `results.csv`. Cells are empty where there is nothing to say, as there is no path length without a path.
///
/// Columns from `solve_ms` to `edges`, `path_length` and `roadmap` are of the search and its first path. `segments`, `min_clearance` and
/// `max_residual` are of the path that is written. `instance` is the number of the varied instance, `refused` the draws that made none, by
/// reason; `settings` their name, where the batch has several; `threads` those of the solve. `id` is the identity of the row: a hash of
/// all that decides it (problem and models, instance, scheduler, settings, limits, seed, version). Columns from `grasp_changes` on are of the
/// improvement, and empty where the batch wants first paths.
pub const COLUMNS: [&str; 29] = [
    "scene",
    "seed",
    "scheduler",
    "outcome",
    "solve_ms",
    "load_ms",
    "steps",
    "candidates",
    "nodes",
    "edges",
    "segments",
    "path_length",
    "min_clearance",
    "max_residual",
    "roadmap",
    "message",
    "instance",
    "settings",
    "threads",
    "refused",
    "id",
    "grasp_changes",
    "first_cost",
    "final_cost",
    "duration",
    "improve_work",
    "improve_ms",
    "timing_ms",
    "untimed",
];

/// Columns of searches.
const SEARCH_COLUMNS: usize = COLUMNS.len() - AnswerNumbers::CELLS;

/// How a solve of a batch ended. [`Row::message`] tells more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RowOutcome {
    /// It gave a path.
    Solved,
    /// The time limit passed first.
    Timeout,
    /// The budget of steps was spent.
    StepLimit,
    /// The host cancelled.
    Cancelled,
    /// It needed more memory than it may have.
    MemoryLimit,
    /// The start cannot be planned from.
    InfeasibleStart,
    /// No goal can be planned to.
    InfeasibleGoal,
    /// It panicked.
    Crashed,
    /// No draw of the varied instance was a problem whose start and goals can be planned for.
    NoInstance,
    /// It could not start, or its answer could not be written.
    Failed,
}

/// What a search did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Work {
    /// Steps.
    pub steps: u64,
    /// Candidates.
    pub candidates: u64,
    /// Roadmap nodes.
    pub nodes: usize,
    /// Roadmap edges.
    pub edges: usize,
    /// Hash of the whole roadmap.
    pub fingerprint: u64,
}

/// What a path is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathNumbers {
    /// Segments of the path that is written.
    pub segments: usize,
    /// Weighted length of the first path, metres.
    pub length: f64,
    /// Proven clearance beyond the margins, metres; none where no pair was tested.
    pub min_clearance: Option<f64>,
    /// Proven bound of the residual, metres and radians.
    pub max_residual: f64,
}

/// One solve.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the problem.
    pub scene: String,
    /// Seed.
    pub seed: u64,
    /// Name of the scheduler.
    pub scheduler: String,
    /// How it ended.
    pub outcome: RowOutcome,
    /// Wall time from the loaded problem, with the bounds of its shapes, to the certified path; of a crash, up to it.
    pub solve_time: Duration,
    /// Wall time of reading the scene and building its model, once for all seeds; of a varied instance, of drawing it.
    pub load_time: Duration,
    /// What the search did, where it came to an end.
    pub work: Option<Work>,
    /// What the path is like, where there is one.
    pub path: Option<PathNumbers>,
    /// What has become of the first path, where the batch improves it.
    pub answer: Option<AnswerNumbers>,
    /// Why there is no answer, where there is a reason to tell.
    pub message: String,
    /// Number of the varied instance; `None` of the problem as it is.
    pub instance: Option<u64>,
    /// Name of the settings; empty where the batch has one.
    pub settings: String,
    /// Threads within the solve.
    pub threads: usize,
    /// Draws that were no instance, by reason.
    pub refused: Rejections,
    /// The row's identity: 32 hexadecimal digits.
    pub id: String,
}

/// Which solve a row is of.
#[derive(Clone, Debug)]
pub(crate) struct Label {
    pub scene: String,
    pub seed: u64,
    pub scheduler: String,
    pub instance: Option<u64>,
    pub settings: String,
    pub threads: usize,
    pub id: String,
}

impl RowOutcome {
    /// The outcome's name: those of searches, `crashed`, `no_instance`, `failed`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Timeout => "timeout",
            Self::StepLimit => "step_limit",
            Self::Cancelled => "cancelled",
            Self::MemoryLimit => "memory_limit",
            Self::InfeasibleStart => "infeasible_start",
            Self::InfeasibleGoal => "infeasible_goal",
            Self::Crashed => "crashed",
            Self::NoInstance => "no_instance",
            Self::Failed => "failed",
        }
    }

    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "solved" => Self::Solved,
            "timeout" => Self::Timeout,
            "step_limit" => Self::StepLimit,
            "cancelled" => Self::Cancelled,
            "memory_limit" => Self::MemoryLimit,
            "infeasible_start" => Self::InfeasibleStart,
            "infeasible_goal" => Self::InfeasibleGoal,
            "crashed" => Self::Crashed,
            "no_instance" => Self::NoInstance,
            "failed" => Self::Failed,
            _ => return None,
        })
    }

    /// The outcome of a solve without a path.
    pub(crate) fn of_reason(reason: &NoSolutionReason) -> Self {
        match reason {
            NoSolutionReason::TimeLimit => Self::Timeout,
            NoSolutionReason::StepLimit => Self::StepLimit,
            NoSolutionReason::Cancelled => Self::Cancelled,
            NoSolutionReason::MemoryLimit => Self::MemoryLimit,
            NoSolutionReason::InfeasibleStart(_) => Self::InfeasibleStart,
            NoSolutionReason::InfeasibleGoal(_) => Self::InfeasibleGoal,
            NoSolutionReason::Crashed(_) => Self::Crashed,
            NoSolutionReason::Threads { .. } | NoSolutionReason::NoPath => Self::Failed,
        }
    }
}

impl Row {
    /// A row of which nothing is known yet.
    pub(crate) fn new(label: Label) -> Self {
        Self {
            scene: label.scene,
            seed: label.seed,
            scheduler: label.scheduler,
            outcome: RowOutcome::Failed,
            solve_time: Duration::ZERO,
            load_time: Duration::ZERO,
            work: None,
            path: None,
            answer: None,
            message: String::new(),
            instance: label.instance,
            settings: label.settings,
            threads: label.threads,
            refused: Rejections::default(),
            id: label.id,
        }
    }

    /// Reads the cells of [`Self::cells`] back; `None` where they are no row.
    // Long: a line for each column.
    pub(crate) fn of_cells(cells: &[String]) -> Option<Self> {
        let (cells, answer) = cells.split_at_checked(SEARCH_COLUMNS)?;
        let [
            scene,
            seed,
            scheduler,
            outcome,
            solve_ms,
            load_ms,
            steps,
            candidates,
            nodes,
            edges,
            segments,
            length,
            clearance,
            residual,
            roadmap,
            message,
            instance,
            settings,
            threads,
            refused,
            id,
        ] = cells
        else {
            return None;
        };
        let time = |cell: &String| Duration::try_from_secs_f64(cell.parse::<f64>().ok()? * 1e-3).ok();
        let work = || {
            Some(Work {
                steps: steps.parse().ok()?,
                candidates: candidates.parse().ok()?,
                nodes: nodes.parse().ok()?,
                edges: edges.parse().ok()?,
                fingerprint: u64::from_str_radix(roadmap, 16).ok()?,
            })
        };
        let path = || {
            let min_clearance = if clearance.is_empty() { None } else { Some(clearance.parse().ok()?) };
            Some(PathNumbers {
                segments: segments.parse().ok()?,
                length: length.parse().ok()?,
                min_clearance,
                max_residual: residual.parse().ok()?,
            })
        };
        Some(Self {
            scene: scene.clone(),
            seed: seed.parse().ok()?,
            scheduler: scheduler.clone(),
            outcome: RowOutcome::named(outcome)?,
            solve_time: time(solve_ms)?,
            load_time: time(load_ms)?,
            work: if steps.is_empty() { None } else { Some(work()?) },
            path: if segments.is_empty() { None } else { Some(path()?) },
            answer: AnswerNumbers::of_cells(answer)?,
            message: message.clone(),
            instance: if instance.is_empty() { None } else { Some(instance.parse().ok()?) },
            settings: settings.clone(),
            threads: threads.parse().ok()?,
            refused: refused.parse().ok()?,
            id: id.clone(),
        })
    }

    /// Whether the solve gave a path.
    #[must_use]
    pub fn is_solved(&self) -> bool {
        self.outcome == RowOutcome::Solved
    }

    /// The cells, in the order of [`COLUMNS`].
    #[must_use]
    pub fn cells(&self) -> [String; COLUMNS.len()] {
        let work = |cell: fn(&Work) -> String| self.work.as_ref().map(cell).unwrap_or_default();
        let path = |cell: fn(&PathNumbers) -> String| self.path.as_ref().map(cell).unwrap_or_default();
        let search: [String; SEARCH_COLUMNS] = [
            self.scene.clone(),
            self.seed.to_string(),
            self.scheduler.clone(),
            self.outcome.name().into(),
            format!("{:.3}", milliseconds(self.solve_time)),
            format!("{:.3}", milliseconds(self.load_time)),
            work(|w| w.steps.to_string()),
            work(|w| w.candidates.to_string()),
            work(|w| w.nodes.to_string()),
            work(|w| w.edges.to_string()),
            path(|p| p.segments.to_string()),
            path(|p| format!("{:?}", p.length)),
            path(|p| p.min_clearance.map(|c| format!("{c:?}")).unwrap_or_default()),
            path(|p| format!("{:?}", p.max_residual)),
            work(|w| format!("{:016x}", w.fingerprint)),
            self.message.clone(),
            self.instance.map(|instance| instance.to_string()).unwrap_or_default(),
            self.settings.clone(),
            self.threads.to_string(),
            self.refused.to_string(),
            self.id.clone(),
        ];
        let answer = self.answer.as_ref().map(AnswerNumbers::cells).unwrap_or_default();
        let mut cells = search.into_iter().chain(answer);
        std::array::from_fn(|_| cells.next().unwrap_or_default())
    }

    /// The row as a line of CSV.
    #[must_use]
    pub fn csv(&self) -> String {
        csv_line(&self.cells())
    }

    /// The row as a JSON object.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "scene": self.scene,
            "seed": self.seed,
            "scheduler": self.scheduler,
            "outcome": self.outcome.name(),
            "solve_ms": milliseconds(self.solve_time),
            "load_ms": milliseconds(self.load_time),
            "steps": self.work.map(|w| w.steps),
            "candidates": self.work.map(|w| w.candidates),
            "nodes": self.work.map(|w| w.nodes),
            "edges": self.work.map(|w| w.edges),
            "segments": self.path.map(|p| p.segments),
            "path_length": self.path.map(|p| p.length),
            "min_clearance": self.path.and_then(|p| p.min_clearance),
            "max_residual": self.path.map(|p| p.max_residual),
            "roadmap": self.work.map(|w| format!("{:016x}", w.fingerprint)),
            "message": self.message,
            "instance": self.instance,
            "settings": self.settings,
            "threads": self.threads,
            "refused": self.refused.to_string(),
            "id": self.id,
            "answer": self.answer.as_ref().map(AnswerNumbers::json),
        })
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
