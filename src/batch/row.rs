//! One solve of a batch, as a row of `results.csv`.

use super::entry::Entry;
use crate::batch::improvement::numbers::AnswerNumbers;
use crate::planner::answer::NoSolutionReason;
use serde_json::{Value, json};
use std::time::Duration;

/// The columns of `results.csv`. Cells are empty where there is nothing to say, as there is no path length without a path.
///
/// Columns from `solve_ms` to `edges`, `path_length` and `roadmap` are of the search and its first path. `segments`, `min_clearance` and
/// `max_residual` are of the path that is written. Columns after `message` are of the improvement, and empty where the batch wants
/// first paths.
pub const COLUMNS: [&str; 24] = [
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
    /// Wall time of reading the scene and building its model, once for all seeds.
    pub load_time: Duration,
    /// What the search did, where it came to an end.
    pub work: Option<Work>,
    /// What the path is like, where there is one.
    pub path: Option<PathNumbers>,
    /// What has become of the first path, where the batch improves it.
    pub answer: Option<AnswerNumbers>,
    /// Why there is no answer, where there is a reason to tell.
    pub message: String,
}

impl RowOutcome {
    /// The outcome's name: those of searches, `crashed`, `failed`.
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
    pub(crate) fn new(entry: &Entry, seed: u64, scheduler: &str) -> Self {
        Self {
            scene: entry.name().into(),
            seed,
            scheduler: scheduler.into(),
            outcome: RowOutcome::Failed,
            solve_time: Duration::ZERO,
            load_time: entry.load_time(),
            work: None,
            path: None,
            answer: None,
            message: String::new(),
        }
    }

    /// Reads the cells of [`Self::cells`] back; `None` where they are no row.
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
            "answer": self.answer.as_ref().map(AnswerNumbers::json),
        })
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// A line of CSV (RFC 4180): cells with commas, quotes or line breaks stand in quotes, quotes in them doubled.
pub(crate) fn csv_line<S: AsRef<str>>(cells: &[S]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| csv_cell(cell.as_ref())).collect();
    cells.join(",") + "\n"
}

fn csv_cell(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::csv_line;

    #[test]
    fn cells_that_need_quotes_have_them() {
        assert_eq!(
            csv_line(&["plain", "a, b", "say \"no\"", "two\nlines", ""]),
            "plain,\"a, b\",\"say \"\"no\"\"\",\"two\nlines\",\n"
        );
    }
}
