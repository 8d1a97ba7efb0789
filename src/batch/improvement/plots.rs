//! One picture per scene: cost over the time of improvement, and durations at the checkpoints.

use crate::batch::error::{BatchError, write_whole};
use crate::batch::improvement::chart::{Chart, TimeAxis};
use crate::batch::improvement::curve::curve;
use crate::batch::improvement::numbers::ImprovementNumbers;
use crate::batch::improvement::quantile::quantile;
use crate::batch::results::row::Row;
use crate::planner::refinement::CostRow;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

/// A scene's picture.
#[derive(Clone, Debug)]
pub(crate) struct Plot {
    /// Name of the problem.
    pub scene: String,
    /// Name of the file.
    pub file: String,
    /// Unit of the cost.
    pub unit: &'static str,
}

/// Times at which the curve of costs is drawn.
const SAMPLES: usize = 240;
/// Earliest time that the axis shows, seconds.
const EARLIEST: f64 = 1e-4;

/// Writes `plots/SCENE.svg` for every scene with improved paths.
pub(crate) fn write(out: &Path, plots: &[Plot], rows: &[Row]) -> Result<(), BatchError> {
    let folder = out.join("plots");
    std::fs::create_dir_all(&folder).map_err(|source| BatchError::Io { path: folder.clone(), source })?;
    for plot in plots {
        let solves = rows.iter().filter(|row| row.scene == plot.scene);
        let solves: Vec<_> = solves.filter_map(|row| row.answer.as_ref()?.improvement.as_ref()).collect();
        if !solves.is_empty() {
            write_whole(&folder.join(&plot.file), &picture(plot, &solves))?;
        }
    }
    Ok(())
}

fn picture(plot: &Plot, solves: &[&ImprovementNumbers]) -> String {
    let axis = time_axis(solves);
    let histories: Vec<&[CostRow]> = solves.iter().map(|solve| solve.history.as_slice()).collect();
    let costs = curve(&histories, &axis.samples(SAMPLES));
    let subtitle =
        format!("{} seeds. Lines: median. Band: 10th to 90th percentile. Bars: shortest to longest.", solves.len());
    let mut chart = Chart::new(&plot.scene, &subtitle, axis);
    let values: Vec<f64> = costs.iter().flat_map(|point| [point.low, point.high]).collect();
    let panel = chart.panel(250.0, &format!("estimated cost of the path ({})", plot.unit), &values);
    chart.band(&panel, &costs.iter().map(|point| (point.seconds, point.low, point.high)).collect::<Vec<_>>());
    chart.line("median", &panel, costs.iter().map(|point| (point.seconds, point.median)));
    let durations = durations(solves);
    let values: Vec<f64> = durations.iter().flat_map(|(_, [shortest, _, longest])| [*shortest, *longest]).collect();
    if !values.is_empty() {
        let panel = chart.panel(170.0, "duration of the timed path at the checkpoints (s)", &values);
        chart.line("timed", &panel, durations.iter().map(|(time, [_, median, _])| (*time, *median)));
        for (time, [shortest, median, longest]) in durations {
            chart.line("timed", &panel, [(time, shortest), (time, longest)]);
            chart.dot(&panel, (time, median));
        }
    }
    chart.svg("time of improvement after the first path (s), logarithmic")
}

/// From the first better path to the last end.
fn time_axis(solves: &[&ImprovementNumbers]) -> TimeAxis {
    let better = solves.iter().flat_map(|solve| solve.history.iter().skip(1).map(|row| row.time));
    let checkpoints = solves.iter().flat_map(|solve| solve.checkpoints.iter().map(|row| row.time));
    let seconds = better.chain(checkpoints).filter(|time| !time.is_zero()).map(|time| time.as_secs_f64());
    let first = seconds.reduce(f64::min).unwrap_or(EARLIEST);
    let last = solves.iter().map(|solve| solve.time.as_secs_f64()).fold(0.0, f64::max);
    TimeAxis::new(first.max(EARLIEST), last)
}

/// Shortest, median and longest duration at each checkpoint that a solve has reached, by time. The end is where the median of the
/// improvements ends.
fn durations(solves: &[&ImprovementNumbers]) -> Vec<(f64, [f64; 3])> {
    let times: BTreeSet<Duration> = solves.iter().flat_map(|s| s.checkpoints.iter().filter_map(|row| row.at)).collect();
    let ends: Vec<f64> = solves.iter().map(|solve| solve.time.as_secs_f64()).collect();
    let end = quantile(&ends, 0.5).unwrap_or_default();
    let places = times.into_iter().map(|at| (at.as_secs_f64(), Some(at))).filter(|(seconds, _)| *seconds < end);
    let at = |(seconds, at): (f64, Option<Duration>)| {
        let found: Vec<f64> = solves.iter().filter_map(|solve| solve.at(at)?.duration).collect();
        Some((seconds, [quantile(&found, 0.0)?, quantile(&found, 0.5)?, quantile(&found, 1.0)?]))
    };
    places.chain([(end, None)]).filter_map(at).collect()
}
