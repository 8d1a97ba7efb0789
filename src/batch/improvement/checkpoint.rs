//! The path at one time of its improvement: a row of `improvement.csv`.

use serde_json::{Value, json};
use std::time::Duration;

/// The columns of `improvement.csv`, a row per solve and checkpoint.
///
/// `id` is that of the solve in `results.csv`. `checkpoint` is `end` in the last row of a solve and the seconds in the others; `seconds`
/// has the wall time since the improvement began in both. `work` is the counted work after which the path was there. `cost` is the cost that is minimised, an estimate;
/// `duration` is how long the path takes once it is smoothed and timed, seconds, empty where it gets no times. `length` is the
/// weighted length without smoothing, metres.
pub const CHECKPOINT_COLUMNS: [&str; 10] =
    ["scene", "seed", "id", "checkpoint", "seconds", "work", "cost", "duration", "grasp_changes", "length"];

/// The columns of `history.csv`, a row for the first path of each solve and for every better one.
pub const HISTORY_COLUMNS: [&str; 6] = ["scene", "seed", "id", "seconds", "work", "cost"];

/// The best path at one time of its improvement.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// The checkpoint, wall time since the improvement began: 0 for the first path; `None` for the end.
    pub at: Option<Duration>,
    /// Wall time since the improvement began.
    pub time: Duration,
    /// Counted work after which the path was there; in the end all of it.
    pub work: u64,
    /// What the path costs.
    pub cost: f64,
    /// How long it takes once it is timed, seconds; `None` where it gets no times.
    pub duration: Option<f64>,
    /// Grasps and releases.
    pub grasp_changes: usize,
    /// Weighted length of the path without times, metres.
    pub length: f64,
}

impl Checkpoint {
    /// Whether it is the last one of its solve.
    #[must_use]
    pub fn is_end(&self) -> bool {
        self.at.is_none()
    }

    /// The cells behind `scene`, `seed` and `id`.
    pub(crate) fn cells(&self) -> [String; CHECKPOINT_COLUMNS.len() - 3] {
        [
            self.at.map_or_else(|| "end".into(), |at| at.as_secs_f64().to_string()),
            format!("{:?}", self.time.as_secs_f64()),
            self.work.to_string(),
            format!("{:?}", self.cost),
            self.duration.map(|duration| format!("{duration:?}")).unwrap_or_default(),
            self.grasp_changes.to_string(),
            format!("{:?}", self.length),
        ]
    }

    /// Reads the cells back; `None` where they are no checkpoint.
    pub(crate) fn of_cells(cells: &[String]) -> Option<Self> {
        let [at, seconds, work, cost, duration, grasp_changes, length] = cells else { return None };
        let time = |cell: &String| Duration::try_from_secs_f64(cell.parse().ok()?).ok();
        Some(Self {
            at: if at == "end" { None } else { Some(time(at)?) },
            time: time(seconds)?,
            work: work.parse().ok()?,
            cost: cost.parse().ok()?,
            duration: if duration.is_empty() { None } else { Some(duration.parse().ok()?) },
            grasp_changes: grasp_changes.parse().ok()?,
            length: length.parse().ok()?,
        })
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "checkpoint": self.at.map(|at| at.as_secs_f64()),
            "seconds": self.time.as_secs_f64(),
            "work": self.work,
            "cost": self.cost,
            "duration": self.duration,
            "grasp_changes": self.grasp_changes,
            "length": self.length,
        })
    }
}
