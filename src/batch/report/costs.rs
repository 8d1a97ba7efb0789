//! What paths cost over the time of their improvement.

use crate::batch::error::BatchError;
use crate::batch::improvement::curve::{CurvePoint, curve};
use crate::batch::report::canvas::{axes, chart, colour, decades, failed, from_zero, svg, time_text};
use crate::batch::report::groups::Group;
use crate::planner::refinement::CostRow;
use plotters::prelude::{Color, IntoLogRange, LineSeries, Polygon};

/// Times at which a curve is drawn.
const SAMPLES: usize = 200;
/// Earliest time that the axis shows, seconds: costs before it are those of the first paths.
const EARLIEST: f64 = 1e-4;

/// A plot of the groups of one scene; none where no path was improved.
pub(crate) fn plot(scene: &str, groups: &[&Group<'_>]) -> Result<Option<String>, BatchError> {
    let histories = |group: &&&Group<'_>| -> Vec<Vec<CostRow>> {
        let improved = group.rows.iter().filter_map(|row| row.answer.as_ref()?.improvement.as_ref());
        improved.map(|improvement| improvement.history.clone()).filter(|history| !history.is_empty()).collect()
    };
    let all: Vec<(usize, Vec<Vec<CostRow>>)> = groups.iter().map(|group| (group.kind, histories(&group))).collect();
    let improvements = groups.iter().flat_map(|group| &group.rows);
    let last = improvements.filter_map(|row| Some(row.answer.as_ref()?.improvement.as_ref()?.time.as_secs_f64()));
    let last = last.fold(0.0, f64::max);
    if all.iter().all(|(_, histories)| histories.is_empty()) || last <= EARLIEST {
        return Ok(None);
    }
    let ratio = last / EARLIEST;
    let times: Vec<f64> =
        (0..SAMPLES).map(|index| EARLIEST * ratio.powf(index as f64 / (SAMPLES - 1) as f64)).collect();
    let curves: Vec<(usize, Vec<CurvePoint>)> = all
        .iter()
        .map(|(kind, histories)| (*kind, curve(&histories.iter().map(Vec::as_slice).collect::<Vec<_>>(), &times)))
        .collect();
    let values = from_zero(curves.iter().flat_map(|(_, points)| points.iter().map(|point| point.high)));
    let axis = decades([EARLIEST, last]).unwrap_or(EARLIEST..1.0);
    let title = format!("{scene}: cost over the time of improvement");
    let drawn = svg(300, &title, |plane| {
        let mut chart = chart(plane).build_cartesian_2d(axis.log_scale(), values).map_err(failed)?;
        axes(&mut chart)
            .x_desc("time of improvement after the first path (logarithmic)")
            .y_desc("estimated cost")
            .x_label_formatter(&|seconds| time_text(*seconds))
            .draw()
            .map_err(failed)?;
        for (kind, points) in curves {
            let colour = colour(kind);
            let there = points.iter().map(|point| (point.seconds, point.low));
            let back = points.iter().rev().map(|point| (point.seconds, point.high));
            let band: Vec<_> = there.chain(back).collect();
            chart.draw_series([Polygon::new(band, colour.mix(0.13))]).map_err(failed)?;
            let line = points.iter().map(|point| (point.seconds, point.median));
            chart.draw_series(LineSeries::new(line, colour.stroke_width(2))).map_err(failed)?;
        }
        Ok(())
    });
    drawn.map(Some)
}
