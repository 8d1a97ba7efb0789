//! Boxes of times: how long solves took, by scene, scheduler and settings.

use crate::batch::error::BatchError;
use crate::batch::improvement::quantile::quantile;
use crate::batch::report::canvas::{axes, colour, decades, failed, left_text, right_text, svg, time_text};
use crate::batch::report::groups::Group;
use plotters::prelude::{ChartBuilder, Circle, Color, IntoLogRange, PathElement, RGBColor, Rectangle, Text};

/// Pixels of one box.
const ROW: u32 = 30;
/// Most pixels and characters of a label.
const LABEL: (u32, usize) = (330, 40);
/// Outliers are what lies farther from the box than so many times its height; drawn as dots, at most so many.
const WHISKER: f64 = 1.5;
const DOTS: usize = 200;

/// A plot of all groups with solved rows; none where nothing was solved. `names` are those of the kinds.
pub(crate) fn plot(groups: &[Group<'_>], names: &[String]) -> Result<Option<String>, BatchError> {
    let Some(axis) = decades(groups.iter().flat_map(Group::times)) else { return Ok(None) };
    let label = |group: &Group<'_>| {
        let text =
            if names.len() == 1 { group.scene.to_owned() } else { format!("{}: {}", group.scene, names[group.kind]) };
        match text.char_indices().nth(LABEL.1) {
            Some((end, _)) => format!("{}…", &text[..end]),
            None => text,
        }
    };
    let labels: Vec<String> = groups.iter().map(label).collect();
    let longest = labels.iter().map(|label| label.chars().count()).max().unwrap_or(0) as u32;
    let left = (24 + 8 * longest).min(LABEL.0);
    let height = 70 + ROW * groups.len() as u32;
    let drawn = svg(height, "times to the first path", |plane| {
        let mut chart = ChartBuilder::on(plane)
            .margin(10)
            .margin_right(70)
            .x_label_area_size(52)
            .y_label_area_size(left)
            .build_cartesian_2d(axis.clone().log_scale(), 0.0..groups.len() as f64)
            .map_err(failed)?;
        axes(&mut chart)
            .disable_y_mesh()
            .disable_y_axis()
            .x_desc("time to the first path (logarithmic)")
            .x_label_formatter(&|seconds| time_text(*seconds))
            .draw()
            .map_err(failed)?;
        for (number, group) in groups.iter().enumerate() {
            let middle = groups.len() as f64 - number as f64 - 0.5;
            let (times, colour) = (group.times(), colour(group.kind));
            let [left_end, right_end] = [axis.start, axis.end].map(|x| chart.backend_coord(&(x, middle)));
            let place = (left_end.0 - 8, left_end.1);
            plane.draw(&Text::new(labels[number].clone(), place, right_text())).map_err(failed)?;
            let count = format!("{}/{}", times.len(), group.rows.len());
            plane.draw(&Text::new(count, (right_end.0 + 8, right_end.1), left_text())).map_err(failed)?;
            let Some(marks) = marks(&times, middle, colour) else { continue };
            chart.draw_series(marks.bodies).map_err(failed)?;
            chart.draw_series(marks.lines).map_err(failed)?;
            chart.draw_series(marks.dots).map_err(failed)?;
        }
        Ok(())
    });
    drawn.map(Some)
}

type Place = (f64, f64);

/// What is drawn for one group.
struct Marks {
    bodies: Vec<Rectangle<Place>>,
    lines: Vec<PathElement<Place>>,
    dots: Vec<Circle<Place, i32>>,
}

/// The box of sorted times at a height, with its whiskers and dots.
fn marks(times: &[f64], middle: f64, colour: RGBColor) -> Option<Marks> {
    let found = Quartiles::of(times)?;
    let line = |points: Vec<Place>, width| PathElement::new(points, colour.stroke_width(width));
    let (below, above) = (middle - 0.28, middle + 0.28);
    let body = [(found.low, below), (found.high, above)];
    let outside = times.iter().filter(|time| **time < found.least || **time > found.most).take(DOTS);
    Some(Marks {
        bodies: vec![Rectangle::new(body, colour.mix(0.25).filled()), Rectangle::new(body, colour.stroke_width(1))],
        lines: vec![
            line(vec![(found.least, middle), (found.low, middle)], 1),
            line(vec![(found.high, middle), (found.most, middle)], 1),
            line(vec![(found.median, below), (found.median, above)], 3),
        ],
        dots: outside.map(|time| Circle::new((*time, middle), 2, colour.mix(0.7).filled())).collect(),
    })
}

/// What a box shows: quartiles, and how far the whiskers reach.
#[derive(Debug, PartialEq)]
struct Quartiles {
    least: f64,
    low: f64,
    median: f64,
    high: f64,
    most: f64,
}

impl Quartiles {
    /// Of sorted values.
    fn of(values: &[f64]) -> Option<Self> {
        let at = |share| quantile(values, share);
        let (low, median, high) = (at(0.25)?, at(0.5)?, at(0.75)?);
        let reach = WHISKER * (high - low);
        let within = |value: &&f64| **value >= low - reach && **value <= high + reach;
        let least = values.iter().find(within).copied().unwrap_or(low).min(low);
        let most = values.iter().rev().find(within).copied().unwrap_or(high).max(high);
        Some(Self { least, low, median, high, most })
    }
}

#[cfg(test)]
mod tests {
    use super::Quartiles;

    #[test]
    fn whiskers_end_at_values_and_leave_outliers_out() {
        let found = Quartiles::of(&[1.0, 2.0, 3.0, 4.0, 5.0, 100.0]).unwrap();
        assert_eq!(found, Quartiles { least: 1.0, low: 2.25, median: 3.5, high: 4.75, most: 5.0 });
        assert_eq!(Quartiles::of(&[]), None);
        let one = Quartiles::of(&[2.0]).unwrap();
        assert_eq!((one.least, one.median, one.most), (2.0, 2.0, 2.0));
    }
}
