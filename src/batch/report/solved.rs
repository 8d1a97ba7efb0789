//! Which share of the problems is solved after how much time.

use crate::batch::error::BatchError;
use crate::batch::report::canvas::{axes, chart, colour, decades, failed, svg, time_text};
use crate::batch::report::groups::Group;
use crate::batch::report::statistics::clopper_pearson;
use plotters::prelude::{Color, IntoLogRange, LineSeries, Polygon};

/// Confidence of the bands.
pub(crate) const CONFIDENCE: f64 = 0.95;

/// The share of one group as it grows: times and shares, with the band.
struct Curve {
    line: Vec<(f64, f64)>,
    band: Vec<(f64, f64)>,
}

/// A plot of the groups of one scene; none where nothing was solved.
pub(crate) fn plot(scene: &str, groups: &[&Group<'_>]) -> Result<Option<String>, BatchError> {
    let Some(axis) = decades(groups.iter().flat_map(|group| group.times())) else { return Ok(None) };
    let title = format!("{scene}: solved over time");
    let drawn = svg(300, &title, |plane| {
        let mut chart = chart(plane).build_cartesian_2d(axis.clone().log_scale(), 0.0..1.0).map_err(failed)?;
        axes(&mut chart)
            .x_desc("time (logarithmic)")
            .y_desc("share that is solved")
            .y_labels(6)
            .x_label_formatter(&|seconds| time_text(*seconds))
            .y_label_formatter(&|share| format!("{:.0} %", share * 100.0))
            .draw()
            .map_err(failed)?;
        for group in groups {
            let curve = curve(group, axis.start, axis.end);
            let colour = colour(group.kind);
            chart.draw_series([Polygon::new(curve.band, colour.mix(0.13))]).map_err(failed)?;
            chart.draw_series(LineSeries::new(curve.line, colour.stroke_width(2))).map_err(failed)?;
        }
        Ok(())
    });
    drawn.map(Some)
}

/// Steps: what is solved by a time is so until the next one.
fn curve(group: &Group<'_>, from: f64, to: f64) -> Curve {
    let (times, all) = (group.times(), group.rows.len());
    let share = |count: usize| count as f64 / all.max(1) as f64;
    let (mut line, mut low, mut high) = (Vec::new(), Vec::new(), Vec::new());
    let ends = times.iter().copied().chain([to]);
    for ((count, begin), end) in std::iter::once(from).chain(times.iter().copied()).enumerate().zip(ends) {
        let (least, most) = clopper_pearson(count, all, CONFIDENCE);
        for time in [begin, end] {
            line.push((time, share(count)));
            low.push((time, least));
            high.push((time, most));
        }
    }
    let band = low.into_iter().chain(high.into_iter().rev()).collect();
    Curve { line, band }
}
