//! How times fall with threads, where rows have several numbers of them.

use crate::batch::error::BatchError;
use crate::batch::improvement::quantile::quantile;
use crate::batch::report::canvas::{GRID, axes, chart, colour, failed, from_zero, svg};
use crate::batch::report::groups::{Group, scenes};
use plotters::prelude::{Circle, Color, LineSeries, PathElement};

/// Median times of one scheduler on one scene, over those with the fewest threads.
#[derive(Debug)]
struct Speedup<'a> {
    scene: &'a str,
    scheduler: &'a str,
    /// Threads, and how many times as fast.
    points: Vec<(f64, f64)>,
}

/// Each scheduler with settings that differ in threads on each scene.
fn speedups<'a>(groups: &[Group<'a>]) -> Vec<Speedup<'a>> {
    let mut found = Vec::new();
    for scene in scenes(groups) {
        let of_scene: Vec<&Group<'_>> = groups.iter().filter(|group| group.scene == scene).collect();
        let mut schedulers: Vec<&str> = of_scene.iter().map(|group| group.scheduler).collect();
        schedulers.dedup();
        for scheduler in schedulers {
            let mut medians: Vec<(usize, f64)> = of_scene
                .iter()
                .filter(|group| group.scheduler == scheduler)
                .filter_map(|group| Some((group.threads, quantile(&group.times(), 0.5)?)))
                .collect();
            medians.sort_by_key(|(threads, _)| *threads);
            medians.dedup_by_key(|(threads, _)| *threads);
            let &[(_, first), _, ..] = medians.as_slice() else { continue };
            let points = medians.iter().map(|(threads, time)| (*threads as f64, first / time)).collect();
            found.push(Speedup { scene, scheduler, points });
        }
    }
    found
}

/// A plot of all speedups, and what each of its lines is, in the order of the colours; none where all rows have one number of threads.
pub(crate) fn plot(groups: &[Group<'_>]) -> Result<Option<(String, Vec<String>)>, BatchError> {
    let speedups = speedups(groups);
    let points = || speedups.iter().flat_map(|speedup| speedup.points.iter().copied());
    let most = points().map(|(threads, _)| threads).fold(0.0, f64::max);
    if speedups.is_empty() {
        return Ok(None);
    }
    let names: Vec<String> =
        speedups.iter().map(|speedup| format!("{}, {}", speedup.scene, speedup.scheduler)).collect();
    let title = format!("times as fast with more threads: {}", names.join("; "));
    let drawn = svg(300, &title, |plane| {
        let values = from_zero(points().map(|(_, factor)| factor).chain([most]));
        let mut chart = chart(plane).build_cartesian_2d(0.8..most + 0.2, values).map_err(failed)?;
        axes(&mut chart)
            .x_desc("threads of a solve")
            .y_desc("times as fast (median)")
            .x_labels(most.min(16.0) as usize + 1)
            .x_label_formatter(&|threads| if threads.fract() == 0.0 { threads.to_string() } else { String::new() })
            .draw()
            .map_err(failed)?;
        // What threads would bring at best.
        let ideal = PathElement::new(vec![(1.0, 1.0), (most, most)], GRID.stroke_width(2));
        chart.draw_series([ideal]).map_err(failed)?;
        for (number, speedup) in speedups.iter().enumerate() {
            let colour = colour(number);
            chart.draw_series(LineSeries::new(speedup.points.clone(), colour.stroke_width(2))).map_err(failed)?;
            let dots = speedup.points.iter().map(|point| Circle::new(*point, 4, colour.filled()));
            chart.draw_series(dots).map_err(failed)?;
        }
        Ok(())
    });
    drawn.map(|svg| Some((svg, names)))
}
