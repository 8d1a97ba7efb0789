//! How good paths are after how much time, over the seeds of each scene and over all scenes.

use crate::batch::error::BatchError;
use crate::batch::improvement::files::read_checkpoints;
use crate::batch::improvement::measurement::Measurement;
use crate::batch::improvement::numbers::ImprovementNumbers;
use crate::batch::improvement::quantile::quantile;
use crate::batch::results::row::Row;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

/// The shortest durations of paths that other runs have found, seconds, by scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BestDurations(pub BTreeMap<String, f64>);

/// The tables, and what has to be said about them.
#[derive(Clone, Debug, PartialEq)]
pub struct ImprovementTable {
    /// How much was spent on each path, and when it was looked at.
    pub measurement: Measurement,
    /// A line per scene that has improved paths.
    pub scenes: Vec<SceneImprovement>,
    /// Improvements that ended before their budget was spent: time limit or memory limit.
    pub cut: usize,
    /// Answers without times.
    pub untimed: usize,
}

/// A scene's lines.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneImprovement {
    /// Name of the problem.
    pub scene: String,
    /// Fewest grasps and releases of a path, over all seeds and checkpoints.
    pub fewest_grasp_changes: usize,
    /// Grasps and releases of each answer, over the fewest.
    pub grasp_ratios: Vec<f64>,
    /// Shortest duration known, seconds: over all seeds and checkpoints, and over [`BestDurations`].
    pub best_duration: Option<f64>,
    /// First path, checkpoints and end.
    pub moments: Vec<Moment>,
}

/// What the paths of all seeds are like at one checkpoint. A path whose improvement has ended by then counts as it was in the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The checkpoint; `None` for the end.
    pub at: Option<Duration>,
    /// Shortest duration, seconds.
    pub shortest: f64,
    /// Median of the durations, seconds.
    pub median: f64,
    /// Longest duration, seconds.
    pub longest: f64,
}

impl BestDurations {
    /// Those of the `improvement.csv` of another run.
    ///
    /// # Errors
    /// The file cannot be read or is no such table.
    pub fn read(path: &Path) -> Result<Self, BatchError> {
        std::fs::metadata(path).map_err(|source| BatchError::Io { path: path.to_owned(), source })?;
        let mut best = BTreeMap::new();
        for (scene, checkpoints) in read_checkpoints(path)?.into_values() {
            let shortest = best.entry(scene).or_insert(f64::INFINITY);
            *shortest = checkpoints.iter().filter_map(|row| row.duration).fold(*shortest, f64::min);
        }
        Ok(Self(best))
    }
}

impl SceneImprovement {
    fn of(scene: &str, solves: &[&ImprovementNumbers], times: &[Duration], best: &BestDurations) -> Option<Self> {
        let all = || solves.iter().flat_map(|solve| &solve.checkpoints);
        let ends = || solves.iter().filter_map(|solve| solve.checkpoints.last());
        let fewest = all().map(|row| row.grasp_changes).min()?;
        let own = all().filter_map(|row| row.duration);
        let known = own.chain(best.0.get(scene).copied());
        // A checkpoint that no improvement has reached would say the same as the end.
        let is_reached = |time: &&Duration| all().any(|row| row.at == Some(**time));
        let between = times.iter().filter(is_reached).map(|time| Some(*time));
        let moments = [Some(Duration::ZERO)].into_iter().chain(between).chain([None]);
        Some(Self {
            scene: scene.into(),
            fewest_grasp_changes: fewest,
            grasp_ratios: ends().map(|row| ratio(row.grasp_changes, fewest)).collect(),
            best_duration: known.reduce(f64::min),
            moments: moments.filter_map(|at| Moment::of(at, solves)).collect(),
        })
    }

    /// The quantile of [`Self::grasp_ratios`].
    fn grasp_ratio(&self, share: f64) -> f64 {
        quantile(&self.grasp_ratios, share).unwrap_or(f64::NAN)
    }
}

/// Grasp changes over the fewest; where none are needed any are infinitely many.
fn ratio(changes: usize, fewest: usize) -> f64 {
    if changes == fewest { 1.0 } else { changes as f64 / fewest as f64 }
}

impl Moment {
    fn of(at: Option<Duration>, solves: &[&ImprovementNumbers]) -> Option<Self> {
        let durations: Vec<f64> = solves.iter().filter_map(|solve| solve.at(at)?.duration).collect();
        let of = |share| quantile(&durations, share);
        Some(Self { at, shortest: of(0.0)?, median: of(0.5)?, longest: of(1.0)? })
    }

    /// Its column's head.
    fn name(&self) -> String {
        match self.at {
            None => "end".into(),
            Some(Duration::ZERO) => "first path".into(),
            Some(time) => format!("{} s", time.as_secs_f64()),
        }
    }

    fn spread(&self) -> f64 {
        self.longest / self.shortest
    }
}

impl ImprovementTable {
    /// Of the rows of some scenes.
    #[must_use]
    pub fn of(measurement: &Measurement, scenes: &[&str], rows: &[Row], best: &BestDurations) -> Self {
        let answers = || rows.iter().filter_map(|row| Some((row, row.answer.as_ref()?)));
        let improved = || answers().filter_map(|(row, answer)| Some((row, answer.improvement.as_ref()?)));
        let scene = |scene: &&str| {
            let solves: Vec<_> = improved().filter(|(row, _)| row.scene == **scene).map(|(_, solve)| solve).collect();
            SceneImprovement::of(scene, &solves, measurement.times(), best)
        };
        Self {
            measurement: measurement.clone(),
            scenes: scenes.iter().filter_map(scene).collect(),
            cut: improved().filter(|(_, solve)| !measurement.is_spent(solve.work, solve.time)).count(),
            untimed: answers().filter(|(_, answer)| answer.duration.is_none()).count(),
        }
    }

    /// The 95th percentile of grasps and releases over the fewest of the scene, over all answers.
    #[must_use]
    pub fn grasp_ratio_95(&self) -> Option<f64> {
        let all: Vec<f64> = self.scenes.iter().flat_map(|scene| scene.grasp_ratios.iter().copied()).collect();
        quantile(&all, 0.95)
    }

    /// The tables in Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut out = format!(
            "\nImprovement: {} each, after the first path. `a (b; c)` is the median duration of the timed paths in seconds, over \
             the best known, and the longest over the shortest of all seeds. Grasp changes are those of the answers; the fewest are of \
             all seeds and checkpoints.\n\n",
            self.measurement.budget()
        );
        let columns = self.columns();
        let names: Vec<String> = columns.iter().map(Moment::name).collect();
        let _ = writeln!(
            out,
            "| scene | fewest grasp changes | median / worst ÷ fewest | best known (s) | {} |",
            names.join(" | ")
        );
        let _ = writeln!(out, "| :-- | --: | --: | --: |{}", " --: |".repeat(columns.len()));
        for scene in &self.scenes {
            let _ = writeln!(
                out,
                "| {} | {} | {} / {} | {} | {} |",
                scene.scene,
                scene.fewest_grasp_changes,
                two(scene.grasp_ratio(0.5)),
                two(scene.grasp_ratio(1.0)),
                scene.best_duration.map_or_else(|| "–".into(), two),
                cells(scene, &columns).join(" | ")
            );
        }
        out.push_str(&self.over_scenes(&columns));
        for (count, what) in [
            (self.cut, "improvements ended before their budget was spent, by the limit of time or memory"),
            (self.untimed, "answers have no times"),
        ] {
            if count > 0 {
                let _ = writeln!(out, "\n{count} {what}.");
            }
        }
        out
    }

    /// First path, the checkpoints that any scene has, and the end.
    fn columns(&self) -> Vec<Moment> {
        let mut columns: Vec<Moment> = self.scenes.iter().flat_map(|scene| scene.moments.iter().copied()).collect();
        // The end comes last.
        columns.sort_by_key(|moment| moment.at.unwrap_or(Duration::MAX));
        columns.dedup_by_key(|moment| moment.at);
        columns
    }

    /// The line of all scenes, and the percentile.
    fn over_scenes(&self, columns: &[Moment]) -> String {
        let median = |values: Vec<f64>| quantile(&values, 0.5).map_or_else(|| "–".into(), two);
        let cell = |column: &Moment| {
            let found = |scene: &SceneImprovement| Some((here(scene, column)?, scene.best_duration?));
            let found: Vec<(Moment, f64)> = self.scenes.iter().filter_map(found).collect();
            let over_best = found.iter().map(|(moment, best)| moment.median / best).collect();
            let spreads = found.iter().map(|(moment, _)| moment.spread()).collect();
            format!("({}; {})", median(over_best), median(spreads))
        };
        let grasps = |share| median(self.scenes.iter().map(|scene| scene.grasp_ratio(share)).collect());
        let cells: Vec<String> = columns.iter().map(cell).collect();
        let mut out = format!("| median of scenes | | {} / {} | | {} |\n", grasps(0.5), grasps(1.0), cells.join(" | "));
        if let Some(ratio) = self.grasp_ratio_95() {
            let _ = writeln!(out, "\n95th percentile of grasp changes ÷ fewest, over all answers: {}.", two(ratio));
        }
        out
    }
}

fn cells(scene: &SceneImprovement, columns: &[Moment]) -> Vec<String> {
    let cell = |column: &Moment| {
        let moment = here(scene, column)?;
        let best = scene.best_duration?;
        Some(format!("{} ({}; {})", two(moment.median), two(moment.median / best), two(moment.spread())))
    };
    columns.iter().map(|column| cell(column).unwrap_or_else(|| "–".into())).collect()
}

/// What a scene has at the checkpoint of a column.
fn here(scene: &SceneImprovement, column: &Moment) -> Option<Moment> {
    scene.moments.iter().find(|moment| moment.at == column.at).copied()
}

/// Two decimals.
fn two(value: f64) -> String {
    if value.is_infinite() { "∞".into() } else { format!("{value:.2}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::improvement::checkpoint::Checkpoint;
    use crate::batch::improvement::measurement::Budget;

    /// A solve with these durations and grasp changes in the beginning, after a second (unless it had ended) and in the end.
    fn solve(durations: [Option<f64>; 3], grasp_changes: usize) -> ImprovementNumbers {
        let times = [Some(Duration::ZERO), Some(Duration::from_secs(1)), None];
        let row = |(at, duration): (Option<Duration>, Option<f64>)| {
            let time = at.unwrap_or(Duration::from_secs(2));
            Some(Checkpoint { at, time, work: 1, cost: 1.0, duration: Some(duration?), grasp_changes, length: 1.0 })
        };
        ImprovementNumbers {
            first_cost: 1.0,
            final_cost: 1.0,
            work: 1,
            time: Duration::from_secs(2),
            checkpoints: times.into_iter().zip(durations).filter_map(row).collect(),
            history: Vec::new(),
        }
    }

    #[test]
    fn moments_hold_the_end_and_ratios_are_over_the_best() {
        let solves = [
            solve([Some(30.0), Some(20.0), Some(10.0)], 2),
            // Its improvement ended before the first second.
            solve([Some(40.0), None, Some(12.0)], 3),
            solve([Some(50.0), Some(24.0), Some(16.0)], 2),
        ];
        let times = [Duration::from_secs(1), Duration::from_secs(9)];
        let best = BestDurations([("demo".to_owned(), 8.0)].into());
        let scene = SceneImprovement::of("demo", &solves.each_ref(), &times, &best).unwrap();
        let medians: Vec<(Option<u64>, f64, f64, f64)> =
            scene.moments.iter().map(|m| (m.at.map(|at| at.as_secs()), m.shortest, m.median, m.longest)).collect();
        assert_eq!(medians, [(Some(0), 30.0, 40.0, 50.0), (Some(1), 12.0, 20.0, 24.0), (None, 10.0, 12.0, 16.0)]);
        assert_eq!((scene.best_duration, scene.fewest_grasp_changes), (Some(8.0), 2));
        let measurement = Measurement::new(Budget::Work(1));
        let table = ImprovementTable { measurement, scenes: vec![scene], cut: 1, untimed: 0 };
        let text = table.markdown();
        assert!(text.contains(
            "| scene | fewest grasp changes | median / worst ÷ fewest | best known (s) | first path | 1 s | end |"
        ));
        assert!(text.contains(
            "| demo | 2 | 1.00 / 1.50 | 8.00 | 40.00 (5.00; 1.67) | 20.00 (2.50; 2.00) | 12.00 (1.50; 1.60) |"
        ));
        assert!(text.contains("| median of scenes | | 1.00 / 1.50 | | (5.00; 1.67) | (2.50; 2.00) | (1.50; 1.60) |"));
        assert!(text.contains("over all answers: 1.45.") && text.contains("1 improvements ended before"), "{text}");
        assert_eq!((ratio(0, 0), ratio(1, 0)), (1.0, f64::INFINITY));
    }
}
