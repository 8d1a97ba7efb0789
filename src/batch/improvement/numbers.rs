//! What has become of a solve's first path: the cells that an improvement adds to a row of `results.csv`.

use crate::batch::improvement::checkpoint::Checkpoint;
use crate::planner::refinement::CostRow;
use serde_json::{Value, json};
use std::time::Duration;

/// What the path is like that is answered.
#[derive(Clone, Debug, PartialEq)]
pub struct AnswerNumbers {
    /// Grasps and releases.
    pub grasp_changes: usize,
    /// How long the path takes, seconds; `None` where it has no times.
    pub duration: Option<f64>,
    /// Wall time of smoothing, timing and certifying the curve.
    pub timing_time: Duration,
    /// Why the path has no times.
    pub untimed: Option<String>,
    /// What the improvement has done; `None` where the path gave it nothing to work on.
    pub improvement: Option<ImprovementNumbers>,
}

/// What the improvement of a solve has done.
#[derive(Clone, Debug, PartialEq)]
pub struct ImprovementNumbers {
    /// Cost of the first path.
    pub first_cost: f64,
    /// Cost of the answer.
    pub final_cost: f64,
    /// Counted work.
    pub work: u64,
    /// Wall time.
    pub time: Duration,
    /// The path in the beginning, at the checkpoints that were reached, and in the end: the rows of `improvement.csv`.
    pub checkpoints: Vec<Checkpoint>,
    /// Cost of the first path and of every better one: the rows of `history.csv`.
    pub history: Vec<CostRow>,
}

impl ImprovementNumbers {
    /// The path at a checkpoint, `None` for the end: that of the end too where the improvement had ended by then.
    #[must_use]
    pub fn at(&self, checkpoint: Option<Duration>) -> Option<&Checkpoint> {
        self.checkpoints.iter().find(|row| row.at == checkpoint).or(self.checkpoints.last())
    }
}

impl AnswerNumbers {
    /// How many cells a row has of them.
    pub(crate) const CELLS: usize = 8;

    /// The cells.
    pub(crate) fn cells(&self) -> [String; Self::CELLS] {
        let improvement =
            |cell: fn(&ImprovementNumbers) -> String| self.improvement.as_ref().map(cell).unwrap_or_default();
        [
            self.grasp_changes.to_string(),
            improvement(|i| format!("{:?}", i.first_cost)),
            improvement(|i| format!("{:?}", i.final_cost)),
            self.duration.map(|duration| format!("{duration:?}")).unwrap_or_default(),
            improvement(|i| i.work.to_string()),
            improvement(|i| format!("{:.3}", milliseconds(i.time))),
            format!("{:.3}", milliseconds(self.timing_time)),
            self.untimed.clone().unwrap_or_default(),
        ]
    }

    /// Reads [`Self::cells`] back, without checkpoints and history; `None` where they are none. Of a row without an answer all are
    /// empty.
    pub(crate) fn of_cells(cells: &[String]) -> Option<Option<Self>> {
        let [grasp_changes, first_cost, final_cost, duration, work, improve_ms, timing_ms, untimed] = cells else {
            return None;
        };
        if cells.iter().all(String::is_empty) {
            return Some(None);
        }
        let time = |cell: &String| Duration::try_from_secs_f64(cell.parse::<f64>().ok()? * 1e-3).ok();
        let improvement = || {
            Some(ImprovementNumbers {
                first_cost: first_cost.parse().ok()?,
                final_cost: final_cost.parse().ok()?,
                work: work.parse().ok()?,
                time: time(improve_ms)?,
                checkpoints: Vec::new(),
                history: Vec::new(),
            })
        };
        Some(Some(Self {
            grasp_changes: grasp_changes.parse().ok()?,
            duration: if duration.is_empty() { None } else { Some(duration.parse().ok()?) },
            timing_time: time(timing_ms)?,
            untimed: if untimed.is_empty() { None } else { Some(untimed.clone()) },
            improvement: if first_cost.is_empty() { None } else { Some(improvement()?) },
        }))
    }

    /// As a JSON object. The history is left out: it is long.
    pub(crate) fn json(&self) -> Value {
        let improvement = self.improvement.as_ref();
        json!({
            "grasp_changes": self.grasp_changes,
            "first_cost": improvement.map(|i| i.first_cost),
            "final_cost": improvement.map(|i| i.final_cost),
            "duration": self.duration,
            "improve_work": improvement.map(|i| i.work),
            "improve_ms": improvement.map(|i| milliseconds(i.time)),
            "timing_ms": milliseconds(self.timing_time),
            "untimed": self.untimed,
            "checkpoints": improvement.map(|i| i.checkpoints.iter().map(Checkpoint::json).collect::<Vec<_>>()),
        })
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
